//! A difference through a first-order filter, what most drivers of haptic devices do.

use crate::estimator::{EstimatedMotion, LARGEST_MOTION_BITS, LARGEST_SURPRISE_BITS, Weight};
use crate::number::Wide as _;
use crate::{Number, Position};

/// `v(n) = v(n-1) + a (x(n) - x(n-1) - v(n-1))`, with the digits of a state, so that no rounding of a slow motion adds up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Smoothed<N: Number> {
    /// `a = 1 - exp(-2π p T)` for a bandwidth `p`.
    pub share: Weight<N>,
}

impl<N: Number> Smoothed<N> {
    /// The motion after a position; `None` where no device could have moved like that.
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
