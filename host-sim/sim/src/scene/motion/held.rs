//! A record of ticks, taken as it stands.

use super::Recording;

/// Samples, each of which holds until the next, as the hand's rest point does in the loop. Nothing is moved, smoothed
/// or interpolated, so that a recording tick by tick comes back bit for bit.
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
