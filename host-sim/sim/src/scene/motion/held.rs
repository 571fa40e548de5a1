//! A recorded hand motion that is replayed without smoothing or interpolation.

use super::Recording;

/// Recorded rest points of the hand, each held until the next sample's time. A recording with one sample per tick is replayed bit
/// for bit.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Held {
    times_s: Vec<f64>,
    values: Vec<f64>,
    /// Time in seconds by which a sample takes effect early, a thousandth of the sample interval. It absorbs the rounding of sample
    /// times that are written in decimals.
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
