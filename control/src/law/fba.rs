//! Force bounding approach (thesis 2.6a–2.10).
//!
//! The energy `E` is what the hand and the device's damping `c_i` have given so far: `E(n) = E(n-1) + f(n-1) Δe + (c_i/T) Δe²`,
//! with force `f`, displacement `Δe` and control period `T`. The force is limited to `|f| <= sqrt(4 E c_i/T)`. Then no next
//! displacement can make the energy negative, counting the device's own damping. The energy under the root is non-negative, and the
//! root is rounded down.

use super::{Contact, Law, Sample, View};
use crate::observer::damping_loss;
use crate::{Energy, Force, Number, Position, Stiffness};

/// Force bounding around a virtual spring: limits the spring's force to what the energy and the device's damping allow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fba<N: Number> {
    /// Desired stiffness of the wall, `k_de`.
    pub desired: Stiffness<N>,
    /// Device damping over the control period, N·m/rad.
    pub device_damping: Stiffness<N>,
    /// `sqrt(4 c_i/T)` for the device damping `c_i` and the control period `T`, rounded down, in the number format of a stiffness.
    pub bound: Stiffness<N>,
    /// Largest force that the law commands.
    pub limit: Force<N>,
    /// Largest energy that the law stores, half of the number format's largest value.
    pub energy_cap: Energy<N>,
}

/// Memory of the force bounding law, [`Fba`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FbaState<N: Number> {
    /// Force of the last tick.
    pub force: Force<N>,
    /// Energy that the hand gave and that the device's damping dissipated so far.
    pub energy: Energy<N>,
    /// Whether the hand's point (HIP) was in the wall at the last tick.
    pub inside: bool,
}

impl<N: Number> Fba<N> {
    /// Largest force that the energy allows, equation (2.7a) of the thesis.
    #[inline]
    pub fn largest_force(&self, energy: Energy<N>) -> Force<N> {
        // The root has the number format of a signal. It is used as a position, so that the bound can multiply it as a stiffness.
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
