//! The mean angle between rotor and field over many samples.

use crate::angle::Angle;

/// Sampled angles between field and rotor, for an assumed direction of the encoder's counting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Fit {
    first: Option<Angle>,
    /// Sum of the sampled angles relative to the first one, in 1/65,536 of a turn; `least` and `most` are the smallest and the
    /// largest of these angles.
    sum: i32,
    pub(super) least: i32,
    pub(super) most: i32,
}

impl Fit {
    pub(super) const EMPTY: Self = Self {
        first: None,
        sum: 0,
        least: 0,
        most: 0,
    };

    pub(super) fn add(&mut self, difference: Angle) {
        let first = *self.first.get_or_insert(difference);
        let relative = i32::from(difference.since(first));
        // The sum is at most 2 · 8 · 50 samples of 2^15.
        self.sum = self.sum.saturating_add(relative);
        self.least = self.least.min(relative);
        self.most = self.most.max(relative);
    }

    pub(super) fn mean(&self, count: i32) -> Angle {
        let mean = self.sum.checked_div(count).unwrap_or(0);
        // The mean is between the least and the most, so it fits into 16 bits.
        self.first.unwrap_or_default().plus(Angle(mean as u16))
    }
}
