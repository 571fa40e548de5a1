//! A recorded hand motion that is replayed without smoothing or interpolation.

use super::Recording;

/// Recorded rest points of the hand. Each is held until the next sample's time, so that a recording with one sample per control
/// period is replayed bit for bit.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Held {
    times_s: Vec<f64>,
    values: Vec<f64>,
    /// Time by which each sample takes effect early, s: a thousandth of the sample interval. It absorbs rounding errors of sample
    /// times in decimal text.
    early_s: f64,
}

impl Held {
    pub fn of(recording: &Recording) -> Self {
        Held {
            times_s: recording.times_s().to_vec(),
            values: recording.angles_rad().to_vec(),
            early_s: 1e-3 * recording.interval_s(),
        }
    }

    pub fn at(&self, time_s: f64) -> f64 {
        let past = self
            .times_s
            .partition_point(|time| *time <= time_s + self.early_s);
        self.values[past.saturating_sub(1)]
    }
}
