//! Properties of the spring, with and without damping, and of successive force augmentation (SFA): limits, and the end of a
//! contact.

use crate::facts::Facts32;
use crate::format::Format;
use crate::functions::Functions32;
use crate::valid::Valid;
use crate::{assume, cover, property, such};
use touchstone_control::law::{Contact, Law, Sample, Sfa, SfaState, Spring, SpringState};
use touchstone_control::{Fixed8, Force, Position};

macro_rules! spring_sfa {
    ($(#[doc = $doc:literal])* $module:ident, $number:ident, functions $functions:ident, by $solver:ident, sums $sums:ident) => {
        $(#[doc = $doc])*
        pub mod $module {
            use super::*;
            type N = $number;
            type F = $functions;

            property! {
                /// P3, P4, P7, spring law: no panic, the force never pulls and is at most the limit. Outside the wall the force is
                /// 0 and the memory is cleared.
                equation "0 <= f <= limit; e <= 0  =>  f = 0, memory cleared"
                over "valid configuration, memory in the invariant, position"
                by $solver fn p4_spring(s) {
                    let law = such!(s, Spring::<N>::any(s), |law| law.valid(), "validate");
                    let before = such!(
                        s, <Spring<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p4_*"
                    );
                    let e = N::any_position(s);
                    let sample = Sample { e, moved: N::any_position(s) };
                    let mut state = before;
                    let force = law.tick(&mut state, sample);
                    assert!(law.holds(&state));
                    assert!(force >= Force::zero() && force <= law.limit);
                    if e <= Position::zero() {
                        assert_reached!(force == Force::zero() && state == SpringState::default());
                    }
                    cover!(s, force == law.limit && force > Force::zero(), "limit reached");
                    cover!(s, e > Position::zero() && force == Force::zero(), "the damper takes it all");
                    cover!(s, before.inside && e < Position::zero(), "leaves");
                }
            }
            property! {
                /// P1 (energy): the plain spring's force is stiffness times penetration, rounded towards zero, or the limit;
                /// nothing depends on the past.
                equation "f = min(floor(k e), limit)"
                over "valid configuration without damping, memory in the invariant, position inside"
                by $sums fn p1_spring_is_a_spring(s) {
                    let mut law = such!(s, Spring::<F>::any(s), |law| law.valid(), "validate");
                    law.damping = touchstone_control::Stiffness::zero();
                    let before = such!(
                        s, <Spring<F> as Valid<F>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p4_*"
                    );
                    let e = F::any_position(s);
                    let sample = Sample { e, moved: F::any_position(s) };
                    assume!(s, e > Position::zero(), "case; outside is p7_leaves");
                    let mut state = before;
                    let force = law.tick(&mut state, sample);
                    assert!(force == (law.desired * e).towards_zero().min(law.limit));
                    cover!(s, force > Force::zero() && force < law.limit, "below the limit");
                }
            }
            property! {
                /// P3, P4 and the invariant, SFA (successive force augmentation) in all its variants: no panic, the force never
                /// pulls and is at most the limit.
                equation "0 <= f <= limit, invariant"
                over "valid configuration, memory in the invariant, position"
                by $solver fn p4_sfa(s) {
                    let law = such!(s, Sfa::<N>::any(s), |law| law.valid(), "validate");
                    let before = such!(
                        s, <Sfa<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p4_*"
                    );
                    let e = N::any_position(s);
                    let sample = Sample { e, moved: N::any_position(s) };
                    let mut state = before;
                    let force = law.tick(&mut state, sample);
                    assert!(law.holds(&state));
                    assert!(force >= Force::zero() && force <= law.limit && force == state.force);
                    cover!(s, force == law.limit && state.contact == Contact::Augmenting, "limit reached");
                    cover!(s, before.contact == Contact::First && state.contact == Contact::Augmenting, "first contact over");
                    cover!(s, e < Position::zero() && force > Force::zero(), "pushes outside the undeformed wall");
                }
            }
            property! {
                /// P7 (end of contact), SFA (successive force augmentation): once the force is 0 the contact is over, and only the
                /// positions are remembered.
                equation "f = 0  =>  memory cleared but for positions"
                over "valid configuration, memory in the invariant, position"
                by $solver fn p7_sfa_leaves(s) {
                    let law = such!(s, Sfa::<N>::any(s), |law| law.valid(), "validate");
                    let before = such!(
                        s, <Sfa<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p4_*"
                    );
                    let e = N::any_position(s);
                    let sample = Sample { e, moved: N::any_position(s) };
                    let mut state = before;
                    let force = law.tick(&mut state, sample);
                    assert!(state.last == e && state.before_last == before.last);
                    if force == Force::zero() && law.limit > Force::zero() {
                        let cleared = SfaState { last: e, before_last: before.last, ..SfaState::default() };
                        assert_reached!(state == cleared);
                    }
                    // In the first contact phase the surface is that of the undeformed wall.
                    let first = before.contact != Contact::Augmenting && state.contact != Contact::Augmenting;
                    assert!(!(first && e <= Position::zero()) || force == Force::zero());
                    cover!(s, before.contact == Contact::Augmenting && force == Force::zero(), "leaves");
                }
            }
        }
    };
}

spring_sfa!(
    /// The properties of this file at 32 bits, the width of the firmware. Of products, quotients and roots only the facts of
    /// [`crate::facts`] are used.
    w32, Facts32, functions Functions32, by cadical, sums cadical
);
spring_sfa!(
    /// The properties of this file at 8 bits, where the model checker refutes wrong changes of the code quickly.
    w8, Fixed8, functions Fixed8, by cadical, sums cadical
);
