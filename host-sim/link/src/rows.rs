//! Converts a board's telemetry records to rows of numbers, which a browser's page draws.

use crate::counted::Counted;
use touchstone_drive::twin::Twin;
use touchstone_protocol::{DeviceSettings, Telemetry};

/// Names of the numbers in a row (one telemetry record), in their order. A number that the page for simulations also draws has the
/// same name there, because the same code draws it.
pub const COLUMNS: [&str; 16] = [
    "clock",
    "tick",
    // Number of records that are missing before this one.
    "missing",
    "angle_rad",
    "surface_shifted_rad",
    // Equal to `angle_rad`, because no record contains the position of the law's virtual mass.
    "mass_rad",
    "force_n_m",
    "motor_force_n_m",
    // NaN while the simulated copy of the device does not run.
    "model_n_m",
    "difference_n_m",
    "energy_observed_j",
    "current_q_a",
    "cycles",
    "lateness_cycles",
    "limits",
    "phase",
];

/// Most rows that are kept until the page fetches them. When one more arrives, all kept rows are removed.
const KEPT: usize = 20_000;

/// Distance from the wall's surface, rad, below which a row takes the position from the record's penetration. Beyond it, where the
/// penetration's number format ends, the row takes the position from the encoder count.
const REACH_RAD: f64 = 127.0;

/// Bytes of a long telemetry record with its frame. The serial line carries 92,160 bytes per second (921,600 baud, ten bits per
/// byte). `LINE_BYTES` of them are for records, the rest for answers.
const RECORD_BYTES: u32 = 36;
const LINE_BYTES: u32 = 80_000;

/// Smallest number of control ticks per telemetry record for which the serial line is fast enough.
#[must_use]
pub fn decimation(settings: &DeviceSettings) -> u16 {
    let line = settings.timing.rate_hz * RECORD_BYTES;
    u16::try_from(line.div_ceil(LINE_BYTES)).unwrap_or(u16::MAX)
}

/// The rows of telemetry that the page has not fetched yet.
#[derive(Default)]
pub struct RecordRows {
    twin: Option<Twin>,
    counted: Counted,
    decimation: u16,
    period_s: f64,
    surface_rad: f64,
    count_rad: f64,
    /// Number of control ticks since the first record, including those of lost records.
    ticks: u64,
    numbers: Vec<f64>,
}

impl RecordRows {
    /// Prepares for records of a device with these settings. `twin` is a simulated copy of the device's control law, whose force is
    /// compared with the device's. The copy is used only if the device sends a record for every tick (`decimation` 1).
    pub fn begin(&mut self, twin: Option<Twin>, decimation: u16, settings: &DeviceSettings) {
        self.twin = twin.filter(|_| decimation == 1);
        self.counted = Counted::default();
        self.decimation = decimation;
        self.period_s = 1.0 / f64::from(settings.timing.rate_hz);
        self.surface_rad = settings.wall.surface_rad.to_num();
        self.count_rad = std::f64::consts::TAU / f64::from(settings.encoder.counts_per_rev);
    }

    /// Adds the row of a telemetry record.
    pub fn push(&mut self, record: &Telemetry) {
        let missing = self.counted.take(record.tick, self.decimation);
        self.ticks += u64::from(self.decimation) * (1 + u64::from(missing));
        let model = self.twin.as_mut().and_then(|twin| twin.tick(record));
        if self.numbers.len() >= KEPT * COLUMNS.len() {
            self.numbers.clear();
        }
        let (deep, counted) = (
            record.penetration_rad.to_num::<f64>(),
            f64::from(record.count) * self.count_rad,
        );
        // The position's number format ends 20 turns from the wall; the count has no such limit.
        let angle = if deep.abs() < REACH_RAD {
            self.surface_rad + deep
        } else {
            counted
        };
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

    /// Returns the numbers of all rows that are kept and removes the rows.
    pub fn numbers(&mut self) -> Vec<f64> {
        std::mem::take(&mut self.numbers)
    }

    /// Removes all rows that are kept and returns them as bytes for the page: the number `batch`, then the rows, as 64-bit floats
    /// with the least significant byte first.
    pub fn take(&mut self, batch: u32) -> Vec<u8> {
        let numbers = self.numbers();
        std::iter::once(f64::from(batch))
            .chain(numbers)
            .flat_map(f64::to_le_bytes)
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_control::CountScale;
    use touchstone_drive::Record;

    #[test]
    fn the_page_turns_on_where_positions_end() {
        let settings = DeviceSettings::default();
        let mut rows = RecordRows::default();
        rows.begin(None, 1, &settings);
        let counts = settings.encoder.counts_per_rev;
        let scale = CountScale::new(counts, settings.wall.surface_rad).unwrap();
        let at = COLUMNS.iter().position(|name| *name == "angle_rad");
        for turns in [0, 19, 21, -21, 10_000, -10_000_i32] {
            let count = turns * counts as i32 + 7;
            let angle = f64::from(count) * std::f64::consts::TAU / f64::from(counts);
            let mut record = Record::empty();
            record.count = count.into();
            record.penetration = scale.penetration(record.count);
            rows.push(&Telemetry::from(&record));
            let shown = rows.numbers()[at.unwrap()];
            assert!((shown - angle).abs() < 1e-7, "{turns}: {shown} for {angle}");
        }
    }
}
