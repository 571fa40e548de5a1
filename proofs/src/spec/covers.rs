//! The conditions that the guard's energy theorem puts on the guard's coefficients: `covers` of `proofs/coq/GuardLosesNothing.v`.

use super::guard::Guard;
use super::{GAIN, SIGNAL};

/// Number of fractional bits that the numbers of a [`Device`] have below a step of the number format.
pub const FINE: u32 = 40;

/// The device of the guard's energy theorem. Distances are in steps of the position format; all numbers have [`FINE`] fractional
/// bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Device {
    /// Fraction of a tick after which a force of the device begins to act.
    pub s: i128,
    /// Largest displacement in one tick, in steps of the position format.
    pub d: i128,
    /// Twice the largest error of a measured position, in steps of the position format.
    pub delta: i128,
    /// Coefficient of the energy charged per squared change of force: at least `s (1-s)/4c`, with the fraction `s` of a tick and
    /// the trusted damping `c` per tick.
    pub kappa: i128,
}

impl Guard {
    /// The theorem's conditions on the coefficients, `covers` of `proofs/coq/GuardLosesNothing.v`, times `2^`[`FINE`]. Each is
    /// returned as its right side minus its left side, and holds if that difference is not negative.
    ///
    /// Measured positions of the device are wrong by at most half of `delta`. It moves at most `d` in a tick, and its forces begin
    /// to act after a fraction `s` of a tick.
    #[must_use]
    pub fn room(&self, device: &Device) -> [(&'static str, i128); 5] {
        let one = 1_i128 << FINE;
        let product = |a: i128, b: i128| -(-(a * b) >> FINE);
        let Device { s, d, delta, kappa } = *device;
        let largest = self.largest_force(self.capacity);
        let half = (delta + 1) >> 1;
        let ratio = |stored: i128| stored << (FINE - SIGNAL);
        let rest = product(one - s, d);
        let slack = half
            + one
            + (s - ratio(self.late)).abs() * self.furthest
            + (kappa - ratio(self.stray)).max(0) * 2 * largest;
        let reach = rest + self.in_flight * one + half;
        [
            ("count", self.count * one - delta),
            ("in flight", self.in_flight * one - product(s, d) - half),
            ("reach", (one << (GAIN + SIGNAL)) - self.per_reach * reach),
            ("slack", self.slack * one - slack),
            (
                "not negative",
                self.overrun
                    .min(self.per_reach)
                    .min(self.damping)
                    .min(self.refill)
                    .min(self.capacity),
            ),
        ]
    }
}
