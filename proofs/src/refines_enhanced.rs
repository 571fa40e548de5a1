//! P11 (refinement): the enhanced law's tick and each of the tick's parts equal their specification, as in `refines.rs`.
//!
//! ```text
//! tick(state, e, Δe) = spec(state, e, Δe)     p11_enhanced_*, p11_augmenting_*
//! each part = its specification               p11_offset, p11_mass_forces, p11_move_*, p11_hand_over_*
//! ```

use crate::format::Format;
use crate::refines::any_sample;
use crate::source::Source;
use crate::valid::{Valid, drive_ok};
use crate::{
    assume, composed_property, cover, divided_property, first_property, multiplied,
    multiplied_property, such,
};
use touchstone_control::filter::VirtualMass;
use touchstone_control::law::{Contact, EnhancedSfa, EnhancedState, Law};
use touchstone_control::{
    Divisor, Energy, FirstContact, Fixed8, Fixed32, Force, Number, ObserverForm, Position,
    Stiffness,
};

/// An enhanced law whose prepared divisors belong to its own stiffnesses, and the sum of its coupling and soft stiffness.
fn any_enhanced<N: Format, S: Source>(
    s: &mut S,
    observer: ObserverForm,
) -> (EnhancedSfa<N>, Stiffness<N>) {
    let law = EnhancedSfa::<N>::any(s);
    let series = N::any_stiffness(s);
    let mass = VirtualMass {
        by_total: Divisor::of(law.mass.total),
        ..law.mass
    };
    let law = EnhancedSfa {
        observer,
        by_coupling: Divisor::of(mass.stiffness),
        series: Divisor::of(series),
        mass,
        ..law
    };
    (law, series)
}

/// Whether an enhanced law is valid, the compliance of its soft spring is not negative, and the stiffnesses by which it divides are
/// above 0.
fn enhanced_ok<N: Format>((law, series): &(EnhancedSfa<N>, Stiffness<N>)) -> bool {
    law.valid()
        && N::of_signal_ratio(law.compliance.0) >= 0
        && N::of_gain(law.mass.stiffness.0) > 0
        && N::of_gain(series.0) > 0
}

fn at<N: Number>(contact: Contact, state: EnhancedState<N>) -> EnhancedState<N> {
    EnhancedState { contact, ..state }
}

macro_rules! refines {
    ($(#[doc = $doc:literal])* $module:ident, $number:ident, $at:ident, by $solver:ident, products $products:ident) => {
        $(#[doc = $doc])*
        pub mod $module {
            use super::*;
            use crate::specified::$at as specified;
            use specified::position;
            type N = $number;

            divided_property! {
                $products
                /// P11 (refinement), enhanced law: a tick outside the wall, and the tick in which the hand touches the wall, equal
                /// the specification's.
                equation "(memory', f) = spec(memory, e, Δe)"
                over "valid configuration, memory in the invariant outside, sample"
                by $solver fn p11_enhanced_touch(s) {
                    let observer = if s.bool() { ObserverForm::Exact } else { ObserverForm::Thesis };
                    let (law, series) = such!(s, any_enhanced::<N, S>(s, observer), |it| enhanced_ok(&it), "validate");
                    let before = such!(s, at(Contact::Free, <EnhancedSfa<N> as Valid<N>>::any_state(s)), |state| law.holds(&state), "invariant, kept by p4_*");
                    let sample = any_sample::<N, S>(s);
                    let mut state = before;
                    multiplied::of_code();
                    let force = specified::force(law.tick(&mut state, sample));
                    multiplied::of_specification();
                    let spec = specified::enhanced(&law, specified::gain(series));
                    let expected = spec.tick(&specified::of_enhanced(&before), position(sample.e), position(sample.moved));
                    assert!(expected == (specified::of_enhanced(&state), force));
                    cover!(s, state.contact == Contact::First, "touches");
                    cover!(s, state.contact == Contact::Free, "stays outside");
                }
            }
            first_property! {
                $products
                /// P11 (refinement), enhanced law: a tick in the first contact phase, until the motion reverses, equals its
                /// specification.
                equation "(memory', f) = spec(memory, e, Δe)"
                over "valid configuration, memory in the invariant in first contact, sample that does not turn back inside"
                by $solver fn p11_enhanced_first(s) {
                    let observer = if s.bool() { ObserverForm::Exact } else { ObserverForm::Thesis };
                    let (law, series) = such!(s, any_enhanced::<N, S>(s, observer), |it| enhanced_ok(&it), "validate");
                    let before = such!(s, at(Contact::First, <EnhancedSfa<N> as Valid<N>>::any_state(s)), |state| law.holds(&state), "invariant, kept by p4_*");
                    let sample = any_sample::<N, S>(s);
                    assume!(
                        s,
                        sample.moved >= Position::zero() || sample.e <= Position::zero(),
                        "case; the other is p11_hand_over_* with p11_augmenting_*"
                    );
                    let mut state = before;
                    multiplied::of_code();
                    let force = specified::force(law.tick(&mut state, sample));
                    multiplied::of_specification();
                    let spec = specified::enhanced(&law, specified::gain(series));
                    let expected = spec.tick(&specified::of_enhanced(&before), position(sample.e), position(sample.moved));
                    assert!(expected == (specified::of_enhanced(&state), force));
                    cover!(s, state.contact == Contact::Free, "left");
                    cover!(s, state.energy > before.energy && state.energy < law.energy_cap, "stored");
                }
            }
            divided_property! {
                $products
                /// P11 (refinement), enhanced law: the hand-over to the virtual mass with the choice that keeps the force equals
                /// its specification.
                equation "memory' = spec(memory)"
                over "valid configuration that keeps the force, memory in the invariant in first contact, a deficit included"
                by $solver fn p11_hand_over_force(s) {
                    let (law, series) = such!(s, any_enhanced::<N, S>(s, ObserverForm::Exact), |it| enhanced_ok(&it), "validate");
                    let law = EnhancedSfa { first_contact: FirstContact::KeepForce, ..law };
                    let before = such!(s, at(Contact::First, <EnhancedSfa<N> as Valid<N>>::any_state(s)), |state| law.holds(&state), "invariant, kept by p4_*");
                    let least = Energy::zero() - N::energy_cap();
                    let energy = such!(s, N::any_energy(s), |energy| energy >= least && energy <= N::energy_cap(), "the tick's work is added before");
                    let before = EnhancedState { energy, ..before };
                    let mut state = before;
                    multiplied::of_code();
                    law.hand_over(&mut state);
                    multiplied::of_specification();
                    let spec = specified::enhanced(&law, specified::gain(series));
                    let expected = spec.hand_over(&specified::of_enhanced(&before));
                    assert!(expected == specified::of_enhanced(&state));
                    cover!(s, state.augmented.mass.position != before.last, "behind");
                    cover!(s, before.energy < Energy::zero(), "with a deficit");
                }
            }
            divided_property! {
                $products
                /// P11 (refinement), enhanced law: the hand-over to the virtual mass with the choice of a zero offset, at rest
                /// between the springs, equals its specification.
                equation "memory' = spec(memory)"
                over "valid configuration that starts without an offset, memory in the invariant in first contact, a deficit included"
                by $solver fn p11_hand_over_rest(s) {
                    let (law, series) = such!(s, any_enhanced::<N, S>(s, ObserverForm::Exact), |it| enhanced_ok(&it), "validate");
                    let law = EnhancedSfa { first_contact: FirstContact::ZeroOffset, ..law };
                    let before = such!(s, at(Contact::First, <EnhancedSfa<N> as Valid<N>>::any_state(s)), |state| law.holds(&state), "invariant, kept by p4_*");
                    let least = Energy::zero() - N::energy_cap();
                    let energy = such!(s, N::any_energy(s), |energy| energy >= least && energy <= N::energy_cap(), "the tick's work is added before");
                    let before = EnhancedState { energy, ..before };
                    let mut state = before;
                    multiplied::of_code();
                    law.hand_over(&mut state);
                    multiplied::of_specification();
                    let spec = specified::enhanced(&law, specified::gain(series));
                    let expected = spec.hand_over(&specified::of_enhanced(&before));
                    assert!(expected == specified::of_enhanced(&state));
                    cover!(s, state.augmented.mass.position != before.last, "behind");
                    cover!(s, before.energy < Energy::zero(), "with a deficit");
                }
            }
            multiplied_property! {
                $products
                /// P11 (refinement), enhanced law: the new offset in a tick equals its specification (thesis Algorithm 3.1, lines 7
                /// to 13).
                equation "O' = spec(memory, e)"
                over "valid configuration, memory in the invariant after the first contact, position"
                by $solver fn p11_offset(s) {
                    let (law, series) = such!(s, any_enhanced::<N, S>(s, ObserverForm::Exact), |it| enhanced_ok(&it), "validate");
                    let before = such!(s, at(Contact::Augmenting, <EnhancedSfa<N> as Valid<N>>::any_state(s)), |state| law.holds(&state), "invariant, kept by p4_*");
                    let e = N::any_position(s);
                    multiplied::of_code();
                    let after = law.offset(&before, e);
                    multiplied::of_specification();
                    let spec = specified::enhanced(&law, specified::gain(series));
                    assert!(position(after) == spec.offset(&specified::of_enhanced(&before), position(e)));
                    cover!(s, after > before.augmented.offset, "grows");
                    cover!(s, after < before.augmented.offset, "shrinks");
                }
            }
            composed_property! {
                $products
                /// P11 (refinement), enhanced law with the exact observer: the tick after the first contact phase equals its
                /// specification: virtual mass, energy and force on the hand.
                equation "(memory', f) = spec(memory, e, Δe)"
                over "valid configuration, memory in the invariant after the first contact, sample"
                by $solver fn p11_augmenting_exact(s) {
                    let (law, series) = such!(s, any_enhanced::<N, S>(s, ObserverForm::Exact), |it| enhanced_ok(&it), "validate");
                    let before = such!(s, at(Contact::Augmenting, <EnhancedSfa<N> as Valid<N>>::any_state(s)), |state| law.holds(&state), "invariant, kept by p4_*");
                    let sample = any_sample::<N, S>(s);
                    let mut state = before;
                    multiplied::of_code();
                    let force = specified::force(law.tick(&mut state, sample));
                    multiplied::of_specification();
                    let spec = specified::enhanced(&law, specified::gain(series));
                    let expected = spec.tick(&specified::of_enhanced(&before), position(sample.e), position(sample.moved));
                    assert!(expected == (specified::of_enhanced(&state), force));
                    cover!(s, state.contact == Contact::Augmenting && force > 0, "pushes");
                    cover!(s, state.contact == Contact::Free, "left");
                    cover!(s, state.contact == Contact::Augmenting && force == 0 && sample.e > Position::zero(), "does not pull");
                }
            }
            composed_property! {
                $products
                /// P11 (refinement), enhanced law with the thesis' observer: the tick after the first contact phase equals its
                /// specification.
                equation "(memory', f) = spec(memory, e, Δe)"
                over "valid configuration, memory in the invariant after the first contact, sample"
                by $solver fn p11_augmenting_thesis(s) {
                    let (law, series) = such!(s, any_enhanced::<N, S>(s, ObserverForm::Thesis), |it| enhanced_ok(&it), "validate");
                    let before = such!(s, at(Contact::Augmenting, <EnhancedSfa<N> as Valid<N>>::any_state(s)), |state| law.holds(&state), "invariant, kept by p4_*");
                    let sample = any_sample::<N, S>(s);
                    let mut state = before;
                    multiplied::of_code();
                    let force = specified::force(law.tick(&mut state, sample));
                    multiplied::of_specification();
                    let spec = specified::enhanced(&law, specified::gain(series));
                    let expected = spec.tick(&specified::of_enhanced(&before), position(sample.e), position(sample.moved));
                    assert!(expected == (specified::of_enhanced(&state), force));
                    cover!(s, state.contact == Contact::Augmenting && force > 0, "pushes");
                    cover!(s, state.contact == Contact::Free, "left");
                }
            }
            divided_property! {
                $products
                /// P11 (refinement), enhanced law: the force that drives the virtual mass, and the coupling's force on the hand,
                /// equal their specification.
                equation "N0 = M d + k_f (e - x) + C Δe, f = trunc(k_f (e - x) + C (Δe - d))"
                over "valid configuration, memory in the invariant after the first contact, sample"
                by $solver fn p11_mass_forces(s) {
                    let (law, series) = such!(s, any_enhanced::<N, S>(s, ObserverForm::Exact), |it| enhanced_ok(&it), "validate");
                    let before = such!(s, at(Contact::Augmenting, <EnhancedSfa<N> as Valid<N>>::any_state(s)), |state| law.holds(&state), "invariant, kept by p4_*");
                    let sample = any_sample::<N, S>(s);
                    let mass = before.augmented.mass;
                    multiplied::of_code();
                    let drive = law.mass.drive(&mass, sample.e, sample.moved);
                    let coupling = law.mass.coupling(&mass, sample.e, sample.moved);
                    multiplied::of_specification();
                    let spec = specified::enhanced(&law, specified::gain(series));
                    let (at, step) = (position(mass.position), position(mass.moved));
                    let (e, moved) = (position(sample.e), position(sample.moved));
                    assert!(specified::tension(drive) == spec.drive(at, step, e, moved));
                    let expected = spec.coupled(at, step, e, moved);
                    assert!(specified::force(coupling) == expected);
                    cover!(s, expected < 0, "pulls");
                }
            }
            divided_property! {
                $products
                /// P11 (refinement), enhanced law: the move of the virtual mass equals its specification if the stored energy
                /// covers it at the requested force.
                equation "(E', f, d') = spec(E, N0, f_wanted)"
                over "valid configuration, position, drive, wanted force, stored energy"
                by $solver fn p11_move_at_full_force(s) {
                    let (law, series) = such!(s, any_enhanced::<N, S>(s, ObserverForm::Exact), |it| enhanced_ok(&it), "validate");
                    let (from, wanted, stored) = (N::any_position(s), N::any_force(s), N::any_energy(s));
                    let drive = such!(s, N::any_tension(s), |drive| drive_ok(&law.mass, drive), "p6_drive_is_exact");
                    assume!(s, wanted > Force::zero(), "what tick passes: the contact ends otherwise");
                    assume!(s, stored >= Energy::zero() && stored <= law.energy_cap, "invariant, kept by p4_augmenting");
                    let mut left = stored;
                    multiplied::of_code();
                    let (force, step) = law.affordable_move(from, drive, wanted, &mut left);
                    assume!(s, force == wanted, "case; the others are p11_move_held_back and p11_move_pulled_out");
                    multiplied::of_specification();
                    let spec = specified::enhanced(&law, specified::gain(series));
                    let expected = spec.paid_move(specified::energy(stored), position(from), specified::tension(drive), specified::force(wanted));
                    assert!(expected == (specified::energy(left), specified::force(force), position(step)));
                    cover!(s, left < stored, "paid");
                    cover!(s, left > stored, "stored");
                }
            }
            divided_property! {
                $products
                /// P11 (refinement), enhanced law: the move of the virtual mass equals its specification if the stored energy
                /// covers it only with a smaller force.
                equation "(E', f, d') = spec(E, N0, f_wanted)"
                over "valid configuration, position, drive, wanted force, stored energy"
                by $solver fn p11_move_held_back(s) {
                    let (law, series) = such!(s, any_enhanced::<N, S>(s, ObserverForm::Exact), |it| enhanced_ok(&it), "validate");
                    let (from, wanted, stored) = (N::any_position(s), N::any_force(s), N::any_energy(s));
                    let drive = such!(s, N::any_tension(s), |drive| drive_ok(&law.mass, drive), "p6_drive_is_exact");
                    assume!(s, wanted > Force::zero(), "what tick passes: the contact ends otherwise");
                    assume!(s, stored >= Energy::zero() && stored <= law.energy_cap, "invariant, kept by p4_augmenting");
                    let mut left = stored;
                    multiplied::of_code();
                    let (force, step) = law.affordable_move(from, drive, wanted, &mut left);
                    assume!(s, force > Force::zero() && force < wanted, "case; the others are p11_move_at_full_force and p11_move_pulled_out");
                    multiplied::of_specification();
                    let spec = specified::enhanced(&law, specified::gain(series));
                    let expected = spec.paid_move(specified::energy(stored), position(from), specified::tension(drive), specified::force(wanted));
                    assert!(expected == (specified::energy(left), specified::force(force), position(step)));
                    cover!(s, left < stored, "paid");
                    cover!(s, step < Position::zero(), "retreats");
                }
            }
            divided_property! {
                $products
                /// P11 (refinement), enhanced law: the move of the virtual mass equals its specification if the mass is pulled out
                /// without a force.
                equation "(E', f, d') = spec(E, N0, f_wanted)"
                over "valid configuration, position, drive, wanted force, stored energy"
                by $solver fn p11_move_pulled_out(s) {
                    let (law, series) = such!(s, any_enhanced::<N, S>(s, ObserverForm::Exact), |it| enhanced_ok(&it), "validate");
                    let (from, wanted, stored) = (N::any_position(s), N::any_force(s), N::any_energy(s));
                    let drive = such!(s, N::any_tension(s), |drive| drive_ok(&law.mass, drive), "p6_drive_is_exact");
                    assume!(s, wanted > Force::zero(), "what tick passes: the contact ends otherwise");
                    assume!(s, stored >= Energy::zero() && stored <= law.energy_cap, "invariant, kept by p4_augmenting");
                    let mut left = stored;
                    multiplied::of_code();
                    let (force, step) = law.affordable_move(from, drive, wanted, &mut left);
                    assume!(s, force <= Force::zero() || force > wanted, "case; the others are p11_move_at_full_force and p11_move_held_back");
                    multiplied::of_specification();
                    let spec = specified::enhanced(&law, specified::gain(series));
                    let expected = spec.paid_move(specified::energy(stored), position(from), specified::tension(drive), specified::force(wanted));
                    assert!(expected == (specified::energy(left), specified::force(force), position(step)));
                    cover!(s, step < Position::zero(), "pulled out");
                }
            }
        }
    };
}

refines!(
    /// The properties of this file at 8 bits, in random tests.
    w8, Fixed8, at8, by sampled, products plain
);
refines!(
    /// The properties of this file at 32 bits, the width of the firmware. Of products, quotients and roots only proved facts are
    /// known.
    w32, Fixed32, at32, by minisat, products multiplied
);
