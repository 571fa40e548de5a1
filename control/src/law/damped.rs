//! The spring-damper with a velocity of its own: what a practitioner does about the counts of a difference.

use super::{Law, Sample, Spring, SpringState, View};
use crate::velocity::{Velocity, VelocityState};
use crate::{Force, Number};

/// A [`Spring`] whose damper takes its velocity from a filter, and whose spring takes the penetration that it is told.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damped<N: Number> {
    /// Spring and damper.
    pub spring: Spring<N>,
    /// What the damper takes for the velocity.
    pub velocity: Velocity<N>,
}

/// Memory of [`Damped`]. Outside, the spring's is cleared; the filter goes on, for it knows the motion with which the wall is met.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DampedState<N: Number> {
    /// The spring's.
    pub spring: SpringState,
    /// The filter's.
    pub velocity: VelocityState<N>,
}

impl<N: Number> Law<N> for Damped<N> {
    type State = DampedState<N>;

    #[inline]
    fn tick(&self, state: &mut DampedState<N>, sample: Sample<N>) -> Force<N> {
        let e = sample.e;
        let moved = self.velocity.tick(&mut state.velocity, e);
        self.spring.tick(&mut state.spring, Sample { e, moved })
    }

    fn view(&self, state: &DampedState<N>) -> View<N> {
        self.spring.view(&state.spring)
    }
}
