//! The spring-damper law with a filtered velocity, the usual remedy for the coarse steps of a difference of encoder counts.

use super::{Law, Sample, Spring, SpringState, View};
use crate::velocity::{Velocity, VelocityState};
use crate::{Force, Number};

/// A [`Spring`] on the penetration that the law gets, with a damper whose velocity comes from a filter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Damped<N: Number> {
    /// Spring and damper.
    pub spring: Spring<N>,
    /// The filter from which the damper gets its velocity.
    pub velocity: Velocity<N>,
}

/// Memory of [`Damped`]. Outside the wall the spring's memory is cleared. The velocity filter continues, so that it has the motion
/// at the next contact.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct DampedState<N: Number> {
    /// Memory of the spring.
    pub spring: SpringState,
    /// Memory of the velocity filter.
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
