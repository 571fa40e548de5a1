//! A Kalman filter of a position alone, in its steady state: Kalata, IEEE TAES 20(2) 174, 1984.

use crate::estimator::{EstimatedMotion, Flow, Weight, corrected};
use crate::{Number, Position};

/// The filter for a motion of constant velocity that white noise changes every tick (`γ = 0`), or of constant acceleration.
///
/// With `r = sqrt(1 - α)` its gains are `α = 1 - r²`, `β = 2 (1 - r)²` and `γ = β²/2α` for whatever noise: one number chooses them,
/// and here that is the natural frequency `p` of its Butterworth poles, `r = exp(-2π p T/√2)` of constant velocity and
/// `r = exp(-2π p T)` of constant acceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tracker<N: Number> {
    /// A tick of free motion.
    pub free: Flow<N, 0>,
    /// `α`, `β`, `γ`.
    pub correction: [Weight<N>; 3],
}

impl<N: Number> Tracker<N> {
    /// The motion after a position; `None` where no device could have moved like that.
    #[inline(always)]
    pub fn tick(&self, before: &EstimatedMotion<N>, at: Position<N>) -> Option<EstimatedMotion<N>> {
        let nothing = Default::default();
        corrected(&self.free, &self.correction, before, &nothing, at)
    }
}
