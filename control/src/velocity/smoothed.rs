//! The difference of two positions through a first-order low-pass filter, as in most drivers of haptic devices.

use crate::estimator::{EstimatedMotion, LARGEST_MOTION_BITS, LARGEST_SURPRISE_BITS, Weight};
use crate::number::Wide as _;
use crate::{Number, Position};

/// First-order low-pass filter of the displacement per tick: `v(n) = v(n-1) + a (x(n) - x(n-1) - v(n-1))` with the position `x`
/// and the gain `a`. The filter calculates with 54 fractional bits, so that rounding errors of a slow motion do not add up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smoothed<N: Number> {
    /// Filter gain `1 - exp(-2π p T)` for a bandwidth `p` in Hz and the control period `T`.
    pub share: Weight<N>,
}

impl<N: Number> Smoothed<N> {
    /// The filter's state after a position; `None` if the motion is implausible by `LARGEST_SURPRISE_BITS` or
    /// `LARGEST_MOTION_BITS`.
    #[inline(always)]
    pub fn tick(&self, before: &EstimatedMotion<N>, at: Position<N>) -> Option<EstimatedMotion<N>> {
        let position = N::widen(at.0);
        let news = position
            .minus_fitting(before.position)
            .minus_fitting(before.moved);
        if !news.within(LARGEST_SURPRISE_BITS) {
            return None;
        }
        let moved = before
            .moved
            .plus_fitting(N::Wide::product(self.share, news.part()));
        moved
            .within(LARGEST_MOTION_BITS)
            .then_some(EstimatedMotion {
                position,
                moved,
                ..*before
            })
    }
}
