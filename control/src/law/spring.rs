//! Virtual spring, equation (1.6) of the thesis, with optional virtual damping (§1.2.6).

use super::{Contact, Law, Sample, View};
use crate::{Force, Number, Position, Stiffness};

/// Virtual spring and damper. The force is stiffness times penetration plus damping per tick times displacement, never pulling, and
/// zero outside the wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring<N: Number> {
    /// Desired stiffness of the wall, `k_de`.
    pub desired: Stiffness<N>,
    /// Virtual damping over the control period; zero for the plain spring.
    pub damping: Stiffness<N>,
    /// Largest force that the law commands.
    pub limit: Force<N>,
}

/// Memory of the spring law, [`Spring`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SpringState {
    /// Whether the hand's point (HIP) was in the wall at the last tick.
    pub inside: bool,
}

impl<N: Number> Law<N> for Spring<N> {
    type State = SpringState;

    #[inline]
    fn tick(&self, state: &mut SpringState, sample: Sample<N>) -> Force<N> {
        // The damper acts only on the part of the displacement inside the wall.
        let (e, moved) = (sample.e, sample.moved_inside());
        if e <= Position::zero() {
            *state = SpringState::default();
            return Force::zero();
        }
        *state = SpringState { inside: true };
        (self.desired * e + self.damping * moved)
            .towards_zero()
            .max(Force::zero())
            .min(self.limit)
    }

    fn view(&self, state: &SpringState) -> View<N> {
        let contact = if state.inside {
            Contact::First
        } else {
            Contact::Free
        };
        View {
            contact,
            energy: None,
            offset: Position::zero(),
            mass: None,
        }
    }
}
