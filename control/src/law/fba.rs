//! Force bounding approach (thesis 2.6a–2.10).
//!
//! `E(n) = E(n-1) + f(n-1) Δe + (c_i/T) Δe²` and `|f| <= sqrt(4 E c_i/T)`: then no next displacement whatever can make the
//! energy, counting the device's own damping, negative. The root is taken of a non-negative energy only, and rounded down.

use super::{Contact, Law, Sample, View};
use crate::observer::damping_loss;
use crate::{Energy, Force, Number, Position, Stiffness};

/// FBA around the spring `k_de`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fba<N: Number> {
    /// Desired stiffness `k_de`.
    pub desired: Stiffness<N>,
    /// Device damping: `c_i/T`.
    pub device_damping: Stiffness<N>,
    /// `sqrt(4 c_i/T)`, rounded down, in the format of a stiffness.
    pub bound: Stiffness<N>,
    /// Largest force ever commanded.
    pub limit: Force<N>,
    /// Cap of the stored energy, see [`super::Tdpa`].
    pub energy_cap: Energy<N>,
}

/// Memory of [`Fba`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FbaState<N: Number> {
    /// Force of the last tick.
    pub force: Force<N>,
    /// Observed energy.
    pub energy: Energy<N>,
    /// Whether the HIP was in the wall.
    pub inside: bool,
}

impl<N: Number> Fba<N> {
    /// Largest force that the energy allows, thesis (2.7a).
    #[inline]
    pub fn largest_force(&self, energy: Energy<N>) -> Force<N> {
        // sqrt(E) has the digits of a signal; as a position it takes the bound as a gain.
        let root = Position(N::root(energy.0));
        (self.bound * root).towards_zero()
    }
}

impl<N: Number> Law<N> for Fba<N> {
    type State = FbaState<N>;

    #[inline]
    fn tick(&self, state: &mut FbaState<N>, sample: Sample<N>) -> Force<N> {
        let (e, moved) = (sample.e, sample.moved_inside());
        if e <= Position::zero() {
            *state = FbaState::default();
            return Force::zero();
        }
        let energy =
            (state.energy + state.force * moved + damping_loss(self.device_damping, moved))
                .min(self.energy_cap);
        let wanted = (self.desired * e).towards_zero().min(self.limit);
        let force = wanted.min(self.largest_force(energy));
        *state = FbaState {
            force,
            energy,
            inside: true,
        };
        force
    }

    fn view(&self, state: &FbaState<N>) -> View<N> {
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
