//! A recording of control periods that is replayed without change.

use super::Recording;

/// Samples, each held until the next, as the loop holds the hand's rest point. Nothing is moved, smoothed or interpolated, so a
/// recording of every tick is replayed bit for bit.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Held {
    times_s: Vec<f64>,
    values: Vec<f64>,
    /// Share of an interval by which a time may come early and still be the sample's: a decimal time need not be the product of
    /// index and period to the last bit.
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
