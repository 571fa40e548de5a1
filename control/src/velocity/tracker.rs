//! A Kalman filter of the position alone with constant gains (its steady state): Kalata, IEEE TAES 20(2) 174, 1984.

use crate::estimator::{EstimatedMotion, Flow, Weight, corrected};
use crate::{Number, Position};

/// The filter for a motion with constant velocity that white noise changes every tick (`γ = 0`), or with constant acceleration.
/// `α`, `β` and `γ` are the gains for position, displacement per tick, and its change.
///
/// With `r = sqrt(1 - α)` the gains are `α = 1 - r²`, `β = 2 (1 - r)²` and `γ = β²/2α`, for any noise. So one number chooses all
/// gains. Here it is the natural frequency `p` of the filter's Butterworth poles: `r = exp(-2π p T/√2)` for constant velocity and
/// `r = exp(-2π p T)` for constant acceleration, with the control period `T`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tracker<N: Number> {
    /// Prediction of the motion over one tick, without damping and commands.
    pub free: Flow<N, 0>,
    /// Gains `α`, `β`, `γ` that correct position, displacement per tick, and the change of that displacement.
    pub correction: [Weight<N>; 3],
}

impl<N: Number> Tracker<N> {
    /// The filter's state after a position; `None` if the motion is implausible by the state estimator's limits (8 rad between
    /// measured and expected position, 4 rad per tick or tick²).
    #[inline(always)]
    pub fn tick(&self, before: &EstimatedMotion<N>, at: Position<N>) -> Option<EstimatedMotion<N>> {
        let nothing = Default::default();
        corrected(&self.free, &self.correction, before, &nothing, at)
    }
}
