//! A control law of one degree of freedom together with its memory, in the form in which walls on three axes call it.

use crate::law::kept::{DampedState, EnhancedState, FbaState, SfaState, TdpaState};
use crate::law::{Contact, Law, Sample, SpringState, View};
use crate::{AnyLaw, Force, Number};

/// A control law of one degree of freedom together with its memory. Walls on three axes use such a law along a direction.
pub trait Along<N: Number> {
    /// Runs one control period: takes penetration and displacement along a direction, returns the outward force.
    fn tick(&mut self, sample: Sample<N>) -> Force<N>;
    /// The law's internal values after the last tick.
    fn view(&self) -> View<N>;
    /// Clears the memory: outside the wall, at rest.
    fn reset(&mut self);
    /// Whether the law is in contact with the wall.
    fn touches(&self) -> bool {
        self.view().contact != Contact::Free
    }
}

impl<N: Number> Along<N> for AnyLaw<N> {
    #[inline]
    fn tick(&mut self, sample: Sample<N>) -> Force<N> {
        Self::tick(self, sample)
    }
    fn view(&self) -> View<N> {
        Self::view(self)
    }
    fn reset(&mut self) {
        match self {
            Self::Spring(_, state) => *state = SpringState::default(),
            Self::Damped(_, state) => *state = DampedState::default(),
            Self::Tdpa(_, state) => *state = TdpaState::default(),
            Self::Fba(_, state) => *state = FbaState::default(),
            Self::Sfa(_, state) => *state = SfaState::default(),
            Self::Enhanced(_, state) => *state = EnhancedState::default(),
        }
    }
}

/// A single law with its memory, for use if the law is known at compile time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Held<N: Number, L: Law<N>> {
    /// The control law.
    pub law: L,
    /// The memory of the law.
    pub state: L::State,
}

impl<N: Number, L: Law<N>> Held<N, L> {
    /// A law without memory, outside the object and at rest.
    pub fn new(law: L) -> Self {
        Self {
            law,
            state: L::State::default(),
        }
    }
}

impl<N: Number, L: Law<N>> Along<N> for Held<N, L> {
    #[inline]
    fn tick(&mut self, sample: Sample<N>) -> Force<N> {
        self.law.tick(&mut self.state, sample)
    }
    fn view(&self) -> View<N> {
        self.law.view(&self.state)
    }
    fn reset(&mut self) {
        self.state = L::State::default();
    }
}
