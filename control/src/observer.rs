//! Energy observers: two forms of the same sum, and what each may promise.
//!
//! Under a zero-order hold the force that acted over the last displacement is the previous one:
//! - [`ObserverForm::Exact`]: `E(n) = E(n-1) + f(n-1) (e(n) - e(n-1))`, the true energy of the port, without a velocity;
//! - [`ObserverForm::Thesis`] (2.1, 2.4): `E(n) = E(n-1) + f(n) (e(n) - e(n-1))`, which reports the sampling leak with the
//!   opposite sign. A controller that chooses `f(n)` can keep *this sum* from ever becoming negative, and that says nothing
//!   about the port.

use crate::{Energy, Force, Number, Position, Stiffness};

crate::choice! {
    /// The force that an observer pairs with the displacement that just happened.
    ObserverForm {
        /// The previous force: the true energy of the port under a zero-order hold.
        #[default]
        Exact = "exact",
        /// The new force, thesis (2.1) and (2.4).
        Thesis = "thesis",
    }
}

/// `c/T · Δ²`: the energy that a damper took over one displacement, rounded down.
#[inline(always)]
pub fn damping_loss<N: Number>(damping: Stiffness<N>, moved: Position<N>) -> Energy<N> {
    (damping * moved).towards_zero() * moved
}

/// The exact observer without a law, for monitoring.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ExactObserver<N: Number> {
    /// Energy so far, J.
    pub energy: Energy<N>,
    position: Position<N>,
    force: Force<N>,
}

impl<N: Number> ExactObserver<N> {
    /// Starts at a position, with no force and no energy.
    #[must_use]
    pub fn new(position: Position<N>) -> Self {
        Self {
            energy: Energy::zero(),
            position,
            force: Force::zero(),
        }
    }

    /// Takes the new position and the force that will act from now on; returns the energy up to now.
    #[inline(always)]
    pub fn tick(&mut self, position: Position<N>, force: Force<N>) -> Energy<N> {
        self.energy = self.energy + self.force * (position - self.position);
        self.position = position;
        self.force = force;
        self.energy
    }
}

/// The thesis' observer on its own.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ThesisObserver<N: Number> {
    /// Energy so far, J.
    pub energy: Energy<N>,
    position: Position<N>,
}

impl<N: Number> ThesisObserver<N> {
    /// Starts at a position, with no energy.
    #[must_use]
    pub fn new(position: Position<N>) -> Self {
        Self {
            energy: Energy::zero(),
            position,
        }
    }

    /// Takes the new position and the new force; returns the sum of thesis (1.4d).
    #[inline(always)]
    pub fn tick(&mut self, position: Position<N>, force: Force<N>) -> Energy<N> {
        self.energy = self.energy + force * (position - self.position);
        self.position = position;
        self.energy
    }
}
