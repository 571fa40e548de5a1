//! Energy observers: two ways to sum the energy that a wall takes from a hand, and what each sum guarantees.
//!
//! `E(n)`, `f(n)` and `e(n)` are energy, force and penetration at tick `n`. A force is held over a tick (zero-order hold), so the
//! force that acted over the last displacement is the previous one:
//! - [`ObserverForm::Exact`]: `E(n) = E(n-1) + f(n-1) (e(n) - e(n-1))`, the true energy of the port, without a velocity;
//! - [`ObserverForm::Thesis`], equations (2.1) and (2.4): `E(n) = E(n-1) + f(n) (e(n) - e(n-1))`, which counts the energy leak of
//!   sampling with the opposite sign. A controller that chooses `f(n)` can keep *this sum* from becoming negative. This says
//!   nothing about the true energy.

use crate::{Energy, Force, Number, Position, Stiffness};

crate::choice! {
    /// The force that an energy observer multiplies with the last displacement.
    ObserverForm {
        /// The previous force, which acted over the displacement. The sum is then the true energy of a force that is held over each
        /// tick.
        #[default]
        Exact = "exact",
        /// The new force, which acts only after the displacement, as in equations (2.1) and (2.4) of the thesis.
        Thesis = "thesis",
    }
}

/// Energy in joules that a damper dissipates over one displacement, rounded down: `damping` (damping over control period, N·m/rad)
/// times the square of the displacement.
#[inline(always)]
pub fn damping_loss<N: Number>(damping: Stiffness<N>, moved: Position<N>) -> Energy<N> {
    (damping * moved).towards_zero() * moved
}

/// The exact energy observer on its own, to monitor a force without a control law. It multiplies each displacement with the force
/// that acted over it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ExactObserver<N: Number> {
    /// Energy taken from the hand so far, J.
    pub energy: Energy<N>,
    position: Position<N>,
    force: Force<N>,
}

impl<N: Number> ExactObserver<N> {
    /// Starts the energy sum at a position, with no force and no energy.
    #[must_use]
    pub fn new(position: Position<N>) -> Self {
        Self {
            energy: Energy::zero(),
            position,
            force: Force::zero(),
        }
    }

    /// Takes the new position and the force that will act from now on. Returns the energy in joules up to this position.
    #[inline(always)]
    pub fn tick(&mut self, position: Position<N>, force: Force<N>) -> Energy<N> {
        self.energy = self.energy + self.force * (position - self.position);
        self.position = position;
        self.force = force;
        self.energy
    }
}

/// The energy observer in the form of the thesis, for use without a control law. It multiplies the new force with the last
/// displacement.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ThesisObserver<N: Number> {
    /// Energy that the thesis' formula counts as taken from the hand so far, J.
    pub energy: Energy<N>,
    position: Position<N>,
}

impl<N: Number> ThesisObserver<N> {
    /// Starts the energy sum at a position, with no energy.
    #[must_use]
    pub fn new(position: Position<N>) -> Self {
        Self {
            energy: Energy::zero(),
            position,
        }
    }

    /// Takes the new position and the new force. Returns the energy sum of equation (1.4d) of the thesis.
    #[inline(always)]
    pub fn tick(&mut self, position: Position<N>, force: Force<N>) -> Energy<N> {
        self.energy = self.energy + force * (position - self.position);
        self.position = position;
        self.energy
    }
}
