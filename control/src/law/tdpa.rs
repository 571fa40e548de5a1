//! Time-domain passivity approach over a virtual spring (thesis 2.1–2.6).
//!
//! With the thesis' observer the force is chosen so that the very sum that uses it never becomes negative: `E >= 0` is an
//! invariant of that sum, to the last bit, and the corrected force is the quotient `E/|Δe|` rounded towards zero. Over a
//! spring there is never anything to correct. For every force that grows with `e`, and its potential `G`,
//! `f(n) Δe(n) >= G(n) - G(n-1)`, so that sum is never negative by itself, and the law is the plain spring.
//!
//! With the exact observer the energy up to now is a fact, the next displacement is not known and is taken to be like the
//! last. Where the motion goes on at least as fast, a deficit is gone after one tick. Where it turns, the correction itself
//! gives away up to `|f|·|Δe|` more, and a motion that turns at every tick makes that happen at every tick, without end. What
//! holds for every next displacement is [`super::Fba`].
//!
//! Where `e` did not change, thesis (2.2) divides by zero. Here nothing can be corrected over a displacement of zero: the
//! deficit stays in `E` for the next tick that moves.

use super::{Contact, Law, Sample, View};
use crate::observer::damping_loss;
use crate::{Energy, Force, Number, ObserverForm, Position, Stiffness};

/// TDPA around the spring `k_de`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tdpa<N: Number> {
    /// Desired stiffness `k_de`.
    pub desired: Stiffness<N>,
    /// The form of the energy observer.
    pub observer: ObserverForm,
    /// `c_i/T` if the device's own damping counts as dissipation (2.6), else zero.
    pub device_damping: Stiffness<N>,
    /// Largest force ever commanded.
    pub limit: Force<N>,
    /// Cap of the stored energy; keeps the sum inside its format. Capping downwards is conservative.
    pub energy_cap: Energy<N>,
}

/// Memory of [`Tdpa`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TdpaState<N: Number> {
    /// Force of the last tick.
    pub force: Force<N>,
    /// Observed energy.
    pub energy: Energy<N>,
    /// Whether the HIP was in the wall.
    pub inside: bool,
}

impl<N: Number> Tdpa<N> {
    /// The force for a displacement after which the thesis' sum must not be negative; updates the sum.
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

    /// The force for the coming tick, given the exact energy so far and the last displacement as a guess of the next.
    #[inline]
    pub fn exact_force(&self, energy: Energy<N>, wanted: Force<N>, moved: Position<N>) -> Force<N> {
        if moved == Position::zero() || energy + wanted * moved >= Energy::zero() {
            return wanted;
        }
        let enough = energy.per_displacement(moved);
        // A deficit is worked off against the motion: more push inward, a pull outward. A surplus that does not suffice
        // outward is spent to the last quantum.
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
