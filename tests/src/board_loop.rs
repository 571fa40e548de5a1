//! Simulates a board's current loop: how the motor's force changes over the control period after a command.

use touchstone_drive::change::{ChangeConfig, law_settings};
use touchstone_drive::wire::hardware;
use touchstone_protocol::{Board, DeviceSettings};

/// PWM periods per control period at 1 kHz.
const PERIODS: u16 = 20;
const PERIOD_S: f64 = 50e-6;

/// A span of time with a constant mean force: whether the span comes after the board's second encoder reading, the force in N·m,
/// and the duration in s.
pub type Stretch = (bool, f64, f64);

/// A board's current loop without motor and sensors, in `f64`. Each PWM period samples the error between commanded and actual
/// force; half a period later, the loop begins to integrate the error.
#[derive(Debug, Clone, Copy)]
pub struct BoardLoop {
    /// How the firmware uses the encoder reading that it takes while the force changes.
    pub change: ChangeConfig,
    /// Fraction of a force error that the loop removes in half a PWM period.
    half: f64,
    force: f64,
    /// Commanded force, to which the loop regulates, N·m.
    asked: f64,
    /// Force error sampled in the previous PWM period, N·m.
    error: f64,
}

impl BoardLoop {
    /// The current loop and the control law's settings of the board Nucleo-G474RE by default. The energy guard's delay in the
    /// settings is the one that the board calculates.
    ///
    /// # Panics
    /// The board refuses its own default settings.
    #[must_use]
    pub fn shipped() -> (Self, touchstone_control::Settings) {
        let board = Board::NucleoG474re;
        let settings = DeviceSettings::defaults(board);
        let (law, change) = law_settings(&settings, hardware(board)).unwrap();
        let bandwidth_hz: f64 = settings.motor.current_bandwidth_hz.to_num();
        let this = Self {
            change: change.unwrap(),
            half: std::f64::consts::TAU * bandwidth_hz * PERIOD_S / 2.0,
            force: 0.0,
            asked: 0.0,
            error: 0.0,
        };
        (this, law)
    }

    /// Simulates one control period after the command `wanted` (N·m). Writes the forces between two encoder readings, each a
    /// quarter of a PWM period after a control tick's sample. The loop receives the command one PWM period after the sample.
    pub fn tick(&mut self, wanted: f64, into: &mut Vec<Stretch>) {
        into.clear();
        for period in 0..=PERIODS {
            if period == 1 {
                self.asked = wanted;
            }
            let is_last = period == PERIODS;
            let before = *self;
            let error = self.asked - self.force;
            let slopes = [self.error, self.error, error, error].map(|it| it * self.half / 2.0);
            for (quarter, slope) in slopes.into_iter().enumerate() {
                let from = self.force;
                self.force += slope;
                let is_in = if is_last {
                    quarter < 1
                } else {
                    period > 0 || quarter >= 1
                };
                if is_in {
                    let read = period > self.change.read_at
                        || period == self.change.read_at && quarter >= 1;
                    into.push((read, (from + self.force) / 2.0, PERIOD_S / 4.0));
                }
            }
            self.error = error;
            if is_last {
                // The next tick begins with this PWM period, so the loop gets back its state from before the period.
                *self = before;
            }
        }
    }
}
