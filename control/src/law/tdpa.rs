//! Time-domain passivity approach over a virtual spring (thesis 2.1–2.6). `E` is the energy that the law's observer has summed, `f`
//! the force, `e` the penetration and `Δe` the displacement in a tick.
//!
//! With the thesis' observer the force is chosen so that the observer's sum, which uses that force, never becomes negative: `E >=
//! 0` holds to the last bit. The corrected force is the quotient `E/|Δe|` rounded towards zero. Over a spring nothing ever needs a
//! correction. For every force that grows with `e`, and its potential energy `G`, `f(n) Δe(n) >= G(n) - G(n-1)`. So the sum never
//! becomes negative, and the law is the plain spring.
//!
//! With the exact observer the energy up to now is known. The next displacement is not known and is assumed to equal the last. If
//! the motion continues at least as fast, a deficit is gone after one tick. If the motion turns, the correction itself gives away
//! up to `|f|·|Δe|` more. A motion that turns at every tick makes this loss happen at every tick, without end. The law whose
//! bound holds for every next displacement is [`super::Fba`].
//!
//! In a tick without a displacement, equation (2.2) of the thesis divides by zero. Nothing can be corrected over a displacement of
//! zero, so the deficit stays in `E` for the next tick with a motion.

use super::{Contact, Law, Sample, View};
use crate::observer::damping_loss;
use crate::{Energy, Force, Number, ObserverForm, Position, Stiffness};

/// Time-domain passivity control around a virtual spring: reduces the spring's force if the wall would give more energy than it
/// took.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tdpa<N: Number> {
    /// Desired stiffness of the wall, `k_de`.
    pub desired: Stiffness<N>,
    /// The form of the energy observer: the exact one or that of the thesis.
    pub observer: ObserverForm,
    /// Device damping over the control period if that damping counts as dissipation, equation (2.6) of the thesis; else zero.
    pub device_damping: Stiffness<N>,
    /// Largest force that the law commands.
    pub limit: Force<N>,
    /// Largest energy that the law stores. The limit keeps the energy sum inside its number format, and a smaller sum only limits
    /// the force more.
    pub energy_cap: Energy<N>,
}

/// Memory of time-domain passivity control, [`Tdpa`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TdpaState<N: Number> {
    /// Force of the last tick.
    pub force: Force<N>,
    /// Energy taken from the hand so far, as the observer sums it.
    pub energy: Energy<N>,
    /// Whether the hand's point (HIP) was in the wall at the last tick.
    pub inside: bool,
}

impl<N: Number> Tdpa<N> {
    /// Returns a force with which the thesis' energy sum does not become negative after the displacement `moved`, and updates the
    /// sum.
    #[inline]
    pub fn thesis_force(
        &self,
        energy: &mut Energy<N>,
        wanted: Force<N>,
        moved: Position<N>,
    ) -> Force<N> {
        let loss = damping_loss(self.device_damping, moved);
        let available = (*energy + loss).min(self.energy_cap);
        let (after, force) = N::passivity_step(available.0, wanted.0, moved.0);
        *energy = Energy(after).min(self.energy_cap);
        Force(force)
    }

    /// Returns a force for the coming tick with which the exact energy does not become negative, if the next displacement equals
    /// the last one.
    #[inline]
    pub fn exact_force(&self, energy: Energy<N>, wanted: Force<N>, moved: Position<N>) -> Force<N> {
        if moved == Position::zero() || energy + wanted * moved >= Energy::zero() {
            return wanted;
        }
        let enough = energy.per_displacement(moved);
        // A force against the motion makes up a deficit: a larger push while the hand moves inward, a pull while it moves
        // outward. A surplus that does not suffice for the outward motion is used up to the last step of the energy format.
        let pulls = energy < Energy::zero() && moved < Position::zero();
        if pulls { -enough } else { enough }
    }
}

impl<N: Number> Law<N> for Tdpa<N> {
    type State = TdpaState<N>;

    #[inline]
    fn tick(&self, state: &mut TdpaState<N>, sample: Sample<N>) -> Force<N> {
        let (e, moved) = (sample.e, sample.moved_inside());
        if e <= Position::zero() {
            *state = TdpaState::default();
            return Force::zero();
        }
        let wanted = (self.desired * e).towards_zero().min(self.limit);
        let force = match self.observer {
            ObserverForm::Thesis => self.thesis_force(&mut state.energy, wanted, moved),
            ObserverForm::Exact => {
                let loss = damping_loss(self.device_damping, moved);
                state.energy = (state.energy + state.force * moved + loss).min(self.energy_cap);
                self.exact_force(state.energy, wanted, moved)
                    .within(self.limit)
            }
        };
        *state = TdpaState {
            force,
            energy: state.energy,
            inside: true,
        };
        force
    }

    fn view(&self, state: &TdpaState<N>) -> View<N> {
        let contact = if state.inside {
            Contact::First
        } else {
            Contact::Free
        };
        View {
            contact,
            energy: Some(state.energy),
            offset: Position::zero(),
            mass: None,
        }
    }
}
