//! Records as rows of numbers, as the page draws them.

use crate::counted::Counted;
use touchstone_drive::twin::Twin;
use touchstone_protocol::{DeviceSettings, Telemetry};

/// Numbers of a record, in their order. What the simulated page has too bears its name, so that the same code draws it.
pub const COLUMNS: [&str; 16] = [
    "clock",
    "tick",
    // Records that are missing before this one.
    "missing",
    "angle_rad",
    "surface_shifted_rad",
    // The virtual mass is in no record.
    "mass_rad",
    "force_n_m",
    "motor_force_n_m",
    // NaN where the model does not run.
    "model_n_m",
    "difference_n_m",
    "energy_observed_j",
    "current_q_a",
    "cycles",
    "lateness_cycles",
    "limits",
    "phase",
];

/// More than this are kept for nobody: who does not fetch them for so long is gone.
const KEPT: usize = 20_000;

/// Bytes of a busy record with its frame, and of the serial line in a second (921,600 baud, ten bits a byte), of which answers need
/// some.
const RECORD_BYTES: u32 = 36;
const LINE_BYTES: u32 = 80_000;

/// Control ticks between two records that the line carries.
#[must_use]
pub fn decimation(settings: &DeviceSettings) -> u16 {
    let line = settings.timing.rate_hz * RECORD_BYTES;
    u16::try_from(line.div_ceil(LINE_BYTES)).unwrap_or(u16::MAX)
}

/// Rows since the last batch.
#[derive(Default)]
pub struct RecordRows {
    twin: Option<Twin>,
    counted: Counted,
    decimation: u16,
    period_s: f64,
    surface_rad: f64,
    /// Control ticks since the page's clock began, gaps included.
    ticks: u64,
    numbers: Vec<f64>,
}

impl RecordRows {
    /// From here on with another model, which follows where every tick is told.
    pub fn begin(&mut self, twin: Option<Twin>, decimation: u16, settings: &DeviceSettings) {
        self.twin = twin.filter(|_| decimation == 1);
        self.counted = Counted::default();
        self.decimation = decimation;
        self.period_s = 1.0 / f64::from(settings.timing.rate_hz);
        self.surface_rad = settings.wall.surface_rad.to_num();
    }

    /// Takes a record.
    pub fn push(&mut self, record: &Telemetry) {
        let missing = self.counted.take(record.tick, self.decimation);
        self.ticks += u64::from(self.decimation) * (1 + u64::from(missing));
        let model = self.twin.as_mut().and_then(|twin| twin.tick(record));
        if self.numbers.len() >= KEPT * COLUMNS.len() {
            self.numbers.clear();
        }
        let angle = self.surface_rad + record.penetration_rad.to_num::<f64>();
        let force: f64 = record.force_n_m.to_num();
        let model: f64 = model.map_or(f64::NAN, |force| force.to_num());
        self.numbers.extend([
            self.ticks as f64 * self.period_s,
            f64::from(record.tick),
            f64::from(missing),
            angle,
            self.surface_rad - record.offset_rad.to_num::<f64>(),
            angle,
            force,
            force,
            model,
            force - model,
            record.energy_j.0.to_num(),
            f64::from(record.current_q_ma) / 1e3,
            f64::from(record.cycles),
            f64::from(record.lateness_cycles),
            f64::from(record.limits),
            f64::from(record.phase as u8),
        ]);
    }

    /// The rows so far, which are gone then.
    pub fn numbers(&mut self) -> Vec<f64> {
        std::mem::take(&mut self.numbers)
    }

    /// The same as a message: numbers of 64 bits, least significant byte first, after the batch's own.
    pub fn take(&mut self, batch: u32) -> Vec<u8> {
        let numbers = self.numbers();
        std::iter::once(f64::from(batch))
            .chain(numbers)
            .flat_map(f64::to_le_bytes)
            .collect()
    }
}
