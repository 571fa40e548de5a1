//! Successive force augmentation without passivity control. The original (thesis 2.11–2.17) changes its offset when the motion
//! turns inwards; a variant changes it at every inward tick (3.2–3.3).
//!
//! Equation (3.2) as printed requires, for the displayed stiffness `k_di` and the desired one `k_de`, `k_di > k_de` *and* `k_di <
//! 0` in its second line, which nothing satisfies. This code uses *or*, as in (2.14c). `k_di < k_de` is decided as `|f| < k_de·e`
//! for a force `f` at a penetration `e`: without a division there is no singularity at `e = 0`.

use super::{Contact, Law, Sample, View};
use crate::{Compliance, FirstContact, Force, Number, OffsetUpdate, Position, Ratio, Stiffness};

/// Successive force augmentation: a soft spring whose offset grows until the force is that of the desired stiffness.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sfa<N: Number> {
    /// Desired stiffness of the wall, `k_de`.
    pub desired: Stiffness<N>,
    /// Stiffness of the soft spring, `k_v`.
    pub soft: Stiffness<N>,
    /// Critical over soft stiffness less 1, `k_c/k_v - 1`: the gain of equation (2.14a) of the thesis.
    pub gain: Ratio<N>,
    /// Compliance of the soft spring: `1/k_v`.
    pub compliance: Compliance<N>,
    /// The ticks (control periods) in which the offset of the soft spring changes.
    pub update: OffsetUpdate,
    /// What happens to the force when the first contact ends (the first reversal of motion).
    pub first_contact: FirstContact,
    /// Largest force that the law commands.
    pub limit: Force<N>,
}

/// Memory of successive force augmentation, [`Sfa`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SfaState<N: Number> {
    /// Phase of the contact: outside, first contact, or augmenting.
    pub contact: Contact,
    /// Penetration of the last tick.
    pub last: Position<N>,
    /// Penetration of the tick before the last one.
    pub before_last: Position<N>,
    /// Offset: the deformation of the soft spring beyond the penetration.
    pub offset: Position<N>,
    /// Force of the last tick.
    pub force: Force<N>,
}

impl<N: Number> Sfa<N> {
    #[inline]
    fn offset_step(&self, state: &SfaState<N>, moved: Position<N>) -> Position<N> {
        let inward = moved > Position::zero();
        let due = match self.update {
            OffsetUpdate::TurnInward => inward && state.last <= state.before_last,
            OffsetUpdate::Inward => inward,
            OffsetUpdate::EveryTick => true,
        };
        if !due {
            return Position::zero();
        }
        let step = self.gain * moved;
        // Equation (2.14c) of the thesis: compares the displayed stiffness of the last tick with the desired one, by
        // cross-multiplication. Outside the wall the displayed stiffness is negative. The force limit is applied first, so that it
        // gives no reason for a larger offset.
        let wanted = (self.desired * state.last).towards_zero().min(self.limit);
        let inside = state.last > Position::zero();
        if inside && state.force < wanted {
            step
        } else if inside && state.force == wanted {
            Position::zero()
        } else {
            -step
        }
    }
}

impl<N: Number> Law<N> for Sfa<N> {
    type State = SfaState<N>;

    #[inline]
    fn tick(&self, state: &mut SfaState<N>, sample: Sample<N>) -> Force<N> {
        let Sample { e, moved } = sample;
        let mut next = SfaState {
            last: e,
            before_last: state.last,
            ..*state
        };
        if state.contact == Contact::Free && e > Position::zero() {
            next.contact = Contact::First;
        }
        if next.contact == Contact::First
            && state.contact == Contact::First
            && moved < Position::zero()
        {
            next.contact = Contact::Augmenting;
            next.offset = match self.first_contact {
                // Equations (2.16) and (2.17) of the thesis: the offset that keeps the force of the first contact at this tick's
                // penetration.
                FirstContact::KeepForce => {
                    let force = (self.desired * e).outward().min(self.limit);
                    self.compliance * force - e
                }
                FirstContact::ZeroOffset => Position::zero(),
            };
        }
        let force = match next.contact {
            Contact::Free => Force::zero(),
            Contact::First => (self.desired * e).towards_zero(),
            Contact::Augmenting => {
                if state.contact == Contact::Augmenting {
                    next.offset = next.offset + self.offset_step(state, moved);
                }
                (self.soft * (e + next.offset)).towards_zero()
            }
        };
        if force <= Force::zero() {
            // The hand has left the wall, including the deformation by the offset: only its position is remembered.
            *state = SfaState {
                last: e,
                before_last: state.last,
                ..SfaState::default()
            };
            return Force::zero();
        }
        next.force = force.min(self.limit);
        *state = next;
        next.force
    }

    fn view(&self, state: &SfaState<N>) -> View<N> {
        View {
            contact: state.contact,
            energy: None,
            offset: state.offset,
            mass: None,
        }
    }
}
