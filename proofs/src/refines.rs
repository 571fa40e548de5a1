//! P11: a tick of the code is a tick of its specification, force and whole memory, to the last bit.
//!
//! `spec/` has no `Number` and shares nothing with the code. At 8 bits the checker compares the two for every configuration, memory
//! and sample; at 32 the same bodies run on samples, and `proofs/tests/spec_*.rs` on millions of ticks.
//!
//! ```text
//! tick(state, e, Δe) = spec(state, e, Δe)     p11_*
//! ```

use crate::format::Format;
use crate::source::Source;
use crate::valid::{Valid, drive_ok};
use crate::{assume, cover, divided_property, multiplied, multiplied_property, property, such};
use touchstone_control::filter::VirtualMass;
use touchstone_control::law::{
    Contact, EnhancedSfa, EnhancedState, Fba, Law, Sample, Sfa, Spring, Tdpa,
};
use touchstone_control::{
    Compliance, Divisor, Energy, FirstContact, Fixed8, Fixed32, Force, Guard, Number, ObserverForm,
    Position, Ratio, Stiffness,
};

fn any_sample<N: Format, S: Source>(s: &mut S) -> Sample<N> {
    Sample {
        e: N::any_position(s),
        moved: N::any_position(s),
    }
}

/// An enhanced law whose divisors are those of its own stiffnesses, with `k_f + k_v`.
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

/// Valid, a ratio of forces not negative, springs that can be divided by.
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
    ($(#[doc = $doc:literal])* $module:ident, $number:ident, $at:ident, by $solver:ident, spring $spring:ident, thesis $thesis:ident, energy $energy:ident, sfa $sfa:ident, offset $offset:ident, first $first:ident, held $held:ident, rest $rest:ident, forces $forces:ident, paid $paid:ident, whole $whole:ident, guard $guard:ident, ends $ends:ident, products $products:ident) => {
        $(#[doc = $doc])*
        pub mod $module {
            use super::*;
            use crate::specified::$at as specified;
            use specified::position;
            type N = $number;

            multiplied_property! {
                $products
                /// P11, spring with damping.
                equation "f = spec(e, Δe), inside' = (e > 0)"
                over "valid configuration, sample"
                by $spring fn p11_spring(s) {
                    let law = such!(s, Spring::<N>::any(s), |law| law.valid(), "validate");
                    let mut state = <Spring<N> as Valid<N>>::any_state(s);
                    let sample = any_sample::<N, S>(s);
                    multiplied::of_code();
                    let force = law.tick(&mut state, sample);
                    multiplied::of_specification();
                    let (k, b, limit) = (specified::gain(law.desired), specified::gain(law.damping), specified::force(law.limit));
                    let expected = specified::spring(k, b, limit, position(sample.e), position(sample.moved));
                    assert!(specified::force(force) == expected && state.inside == (sample.e > Position::zero()));
                    cover!(s, expected == limit && limit > 0, "limit");
                    cover!(s, expected == 0 && sample.e > Position::zero() && k > 0, "damped to nothing");
                }
            }
            property! {
                /// P11, TDPA with the thesis' observer, inside.
                equation "(E', f) = spec(E, e, Δe)"
                over "valid configuration, memory in the invariant, sample inside"
                by $thesis fn p11_tdpa_thesis(s) {
                    let law = such!(s, Tdpa { observer: ObserverForm::Thesis, ..Tdpa::<N>::any(s) }, |law| law.valid(), "validate");
                    let before = such!(s, <Tdpa<N> as Valid<N>>::any_state(s), |state| law.holds(&state), "invariant, kept by p4_*");
                    let sample = any_sample::<N, S>(s);
                    assume!(s, sample.e > Position::zero(), "case; outside is tdpa::p7_leaves");
                    let mut state = before;
                    let force = specified::force(law.tick(&mut state, sample));
                    let spec = specified::tdpa(&law);
                    let expected = spec.tick(&specified::of_tdpa(&before), position(sample.e), position(sample.moved));
                    assert!(expected == (specified::of_tdpa(&state), force));
                    cover!(s, state.force > Force::zero() && expected.0.energy == 0, "spent");
                    cover!(s, state.energy > before.energy, "stored");
                }
            }
            property! {
                /// P11, TDPA with the exact observer, inside: the energy.
                equation "E' = spec(E, e, Δe)"
                over "valid configuration, memory in the invariant, sample inside"
                by $energy fn p11_tdpa_exact_energy(s) {
                    let law = such!(s, Tdpa { observer: ObserverForm::Exact, ..Tdpa::<N>::any(s) }, |law| law.valid(), "validate");
                    let before = such!(s, <Tdpa<N> as Valid<N>>::any_state(s), |state| law.holds(&state), "invariant, kept by p4_*");
                    let sample = any_sample::<N, S>(s);
                    assume!(s, sample.e > Position::zero(), "case; outside is tdpa::p7_leaves");
                    let mut state = before;
                    let _ = law.tick(&mut state, sample);
                    let spec = specified::tdpa(&law);
                    let expected = spec.tick(&specified::of_tdpa(&before), position(sample.e), position(sample.moved));
                    assert!(expected.0.energy == specified::energy(state.energy) && state.inside);
                    cover!(s, state.energy < Energy::zero(), "deficit");
                    cover!(s, state.energy == law.energy_cap, "cap");
                }
            }
            property! {
                /// P11, TDPA with the exact observer, inside: the force.
                equation "f = spec(E, e, Δe)"
                over "valid configuration, memory in the invariant, sample inside"
                by $solver fn p11_tdpa_exact_force(s) {
                    let law = such!(s, Tdpa { observer: ObserverForm::Exact, ..Tdpa::<N>::any(s) }, |law| law.valid(), "validate");
                    let before = such!(s, <Tdpa<N> as Valid<N>>::any_state(s), |state| law.holds(&state), "invariant, kept by p4_*");
                    let sample = any_sample::<N, S>(s);
                    assume!(s, sample.e > Position::zero(), "case; outside is tdpa::p7_leaves");
                    let mut state = before;
                    let force = law.tick(&mut state, sample);
                    let spec = specified::tdpa(&law);
                    let expected = spec.tick(&specified::of_tdpa(&before), position(sample.e), position(sample.moved));
                    assert!(expected.1 == specified::force(force) && state.force == force);
                    cover!(s, force < Force::zero(), "pulls");
                    cover!(s, force > Force::zero() && force < law.limit, "between");
                }
            }
            property! {
                /// P11, force bounding, inside, with the bound that `Controller::new` takes of the damping.
                equation "(E', f) = spec(E, f(n-1), e, Δe)"
                over "valid configuration, memory in the invariant, sample inside"
                by $solver fn p11_fba(s) {
                    let law = such!(s, Fba::<N>::any(s), |law| law.valid(), "validate");
                    let law = Fba { bound: Stiffness(N::root_of_four(law.device_damping.0)), ..law };
                    let before = such!(s, <Fba<N> as Valid<N>>::any_state(s), |state| law.holds(&state), "invariant, kept by p4_*");
                    let sample = any_sample::<N, S>(s);
                    assume!(s, sample.e > Position::zero(), "case; outside is fba::p7_leaves");
                    let mut state = before;
                    let force = specified::force(law.tick(&mut state, sample));
                    let spec = specified::fba(&law);
                    let expected = spec.tick(&specified::of_fba(&before), position(sample.e), position(sample.moved));
                    assert!(expected == (specified::of_fba(&state), force));
                    cover!(s, expected.0.energy < 0, "deficit");
                    cover!(s, force > 0 && force < specified::force(law.limit), "bounded");
                }
            }
            multiplied_property! {
                $products
                /// P11, SFA, original and continuous, from every memory.
                equation "(memory', f) = spec(memory, e, Δe)"
                over "valid configuration with a limit above 0 and ratios not negative, memory in the invariant, sample"
                by $sfa fn p11_sfa(s) {
                    let law = such!(
                        s, Sfa::<N>::any(s),
                        |law| law.valid() && law.limit > Force::zero() && law.gain >= Ratio::zero() && law.compliance >= Compliance::zero(),
                        "validate: the least limit is 16 quanta; p8_conversions32: a ratio is not negative"
                    );
                    let before = such!(s, <Sfa<N> as Valid<N>>::any_state(s), |state| law.holds(&state), "invariant, kept by p4_*");
                    let sample = any_sample::<N, S>(s);
                    let mut state = before;
                    multiplied::of_code();
                    let force = specified::force(law.tick(&mut state, sample));
                    multiplied::of_specification();
                    let spec = specified::sfa(&law);
                    let expected = spec.tick(&specified::of_sfa(&before), position(sample.e), position(sample.moved));
                    assert!(expected == (specified::of_sfa(&state), force));
                    cover!(s, before.contact == Contact::Augmenting && state.offset > before.offset, "grows");
                    cover!(s, before.contact == Contact::First && state.contact == Contact::Augmenting && state.offset != Position::zero(), "turned");
                    cover!(s, before.contact == Contact::Augmenting && state.contact == Contact::Free, "left");
                }
            }
            property! {
                /// P11, enhanced law, outside and at the touch.
                equation "(memory', f) = spec(memory, e, Δe)"
                over "valid configuration, memory in the invariant outside, sample"
                by $first fn p11_enhanced_touch(s) {
                    let observer = if s.bool() { ObserverForm::Exact } else { ObserverForm::Thesis };
                    let (law, series) = such!(s, any_enhanced::<N, S>(s, observer), |it| enhanced_ok(&it), "validate");
                    let before = such!(s, at(Contact::Free, <EnhancedSfa<N> as Valid<N>>::any_state(s)), |state| law.holds(&state), "invariant, kept by p4_*");
                    let sample = any_sample::<N, S>(s);
                    let mut state = before;
                    let force = specified::force(law.tick(&mut state, sample));
                    let spec = specified::enhanced(&law, specified::gain(series));
                    let expected = spec.tick(&specified::of_enhanced(&before), position(sample.e), position(sample.moved));
                    assert!(expected == (specified::of_enhanced(&state), force));
                    cover!(s, state.contact == Contact::First, "touches");
                    cover!(s, state.contact == Contact::Free, "stays outside");
                }
            }
            divided_property! {
                /// P11, enhanced law, the first contact, until it turns back.
                equation "(memory', f) = spec(memory, e, Δe)"
                over "valid configuration, memory in the invariant in first contact, sample that does not turn back inside"
                by $first fn p11_enhanced_first(s) {
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
                    let force = specified::force(law.tick(&mut state, sample));
                    let spec = specified::enhanced(&law, specified::gain(series));
                    let expected = spec.tick(&specified::of_enhanced(&before), position(sample.e), position(sample.moved));
                    assert!(expected == (specified::of_enhanced(&state), force));
                    cover!(s, state.contact == Contact::Free, "left");
                    cover!(s, state.energy > before.energy && state.energy < law.energy_cap, "stored");
                }
            }
            property! {
                /// P11, enhanced law, the hand-over to the mass, with its force kept.
                equation "memory' = spec(memory)"
                over "valid configuration that keeps the force, memory in the invariant in first contact"
                by $held fn p11_hand_over_force(s) {
                    let (law, series) = such!(s, any_enhanced::<N, S>(s, ObserverForm::Exact), |it| enhanced_ok(&it), "validate");
                    let law = EnhancedSfa { first_contact: FirstContact::KeepForce, ..law };
                    let before = such!(s, at(Contact::First, <EnhancedSfa<N> as Valid<N>>::any_state(s)), |state| law.holds(&state), "invariant, kept by p4_*");
                    let mut state = before;
                    law.hand_over(&mut state);
                    let spec = specified::enhanced(&law, specified::gain(series));
                    let expected = spec.hand_over(&specified::of_enhanced(&before));
                    assert!(expected == specified::of_enhanced(&state));
                    cover!(s, state.augmented.mass.position != before.last, "behind");
                }
            }
            divided_property! {
                /// P11, enhanced law, the hand-over to the mass, at rest between its springs.
                equation "memory' = spec(memory)"
                over "valid configuration that starts without an offset, memory in the invariant in first contact"
                by $rest fn p11_hand_over_rest(s) {
                    let (law, series) = such!(s, any_enhanced::<N, S>(s, ObserverForm::Exact), |it| enhanced_ok(&it), "validate");
                    let law = EnhancedSfa { first_contact: FirstContact::ZeroOffset, ..law };
                    let before = such!(s, at(Contact::First, <EnhancedSfa<N> as Valid<N>>::any_state(s)), |state| law.holds(&state), "invariant, kept by p4_*");
                    let mut state = before;
                    law.hand_over(&mut state);
                    let spec = specified::enhanced(&law, specified::gain(series));
                    let expected = spec.hand_over(&specified::of_enhanced(&before));
                    assert!(expected == specified::of_enhanced(&state));
                    cover!(s, state.augmented.mass.position != before.last, "behind");
                }
            }
            multiplied_property! {
                $products
                /// P11, enhanced law, the step of the offset (Algorithm 3.1, lines 7 to 13).
                equation "O' = spec(memory, e)"
                over "valid configuration, memory in the invariant after the first contact, position"
                by $offset fn p11_offset(s) {
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
            property! {
                /// P11, enhanced law with the exact observer, after the first contact: the mass, its energy, the force on the hand.
                equation "(memory', f) = spec(memory, e, Δe)"
                over "valid configuration, memory in the invariant after the first contact, sample"
                by $whole fn p11_augmenting_exact(s) {
                    let (law, series) = such!(s, any_enhanced::<N, S>(s, ObserverForm::Exact), |it| enhanced_ok(&it), "validate");
                    let before = such!(s, at(Contact::Augmenting, <EnhancedSfa<N> as Valid<N>>::any_state(s)), |state| law.holds(&state), "invariant, kept by p4_*");
                    let sample = any_sample::<N, S>(s);
                    let mut state = before;
                    let force = specified::force(law.tick(&mut state, sample));
                    let spec = specified::enhanced(&law, specified::gain(series));
                    let expected = spec.tick(&specified::of_enhanced(&before), position(sample.e), position(sample.moved));
                    assert!(expected == (specified::of_enhanced(&state), force));
                    cover!(s, state.contact == Contact::Augmenting && force > 0, "pushes");
                    cover!(s, state.contact == Contact::Free, "left");
                    cover!(s, state.contact == Contact::Augmenting && force == 0 && sample.e > Position::zero(), "does not pull");
                }
            }
            property! {
                /// P11, enhanced law with the thesis' observer, after the first contact.
                equation "(memory', f) = spec(memory, e, Δe)"
                over "valid configuration, memory in the invariant after the first contact, sample"
                by $whole fn p11_augmenting_thesis(s) {
                    let (law, series) = such!(s, any_enhanced::<N, S>(s, ObserverForm::Thesis), |it| enhanced_ok(&it), "validate");
                    let before = such!(s, at(Contact::Augmenting, <EnhancedSfa<N> as Valid<N>>::any_state(s)), |state| law.holds(&state), "invariant, kept by p4_*");
                    let sample = any_sample::<N, S>(s);
                    let mut state = before;
                    let force = specified::force(law.tick(&mut state, sample));
                    let spec = specified::enhanced(&law, specified::gain(series));
                    let expected = spec.tick(&specified::of_enhanced(&before), position(sample.e), position(sample.moved));
                    assert!(expected == (specified::of_enhanced(&state), force));
                    cover!(s, state.contact == Contact::Augmenting && force > 0, "pushes");
                    cover!(s, state.contact == Contact::Free, "left");
                }
            }
            property! {
                /// P11, enhanced law: what drives the mass, and what the coupling shows.
                equation "N0 = M d + k_f (e - x) + C Δe, f = floor(k_f (e - x) + C (Δe - d))"
                over "valid configuration, memory in the invariant after the first contact, sample"
                by $forces fn p11_mass_forces(s) {
                    let (law, series) = such!(s, any_enhanced::<N, S>(s, ObserverForm::Exact), |it| enhanced_ok(&it), "validate");
                    let before = such!(s, at(Contact::Augmenting, <EnhancedSfa<N> as Valid<N>>::any_state(s)), |state| law.holds(&state), "invariant, kept by p4_*");
                    let sample = any_sample::<N, S>(s);
                    let mass = before.augmented.mass;
                    let spec = specified::enhanced(&law, specified::gain(series));
                    let memory = specified::of_enhanced(&before);
                    let (e, moved) = (position(sample.e), position(sample.moved));
                    assert!(specified::tension(law.mass.drive(&mass, sample.e, sample.moved)) == spec.drive(&memory, e, moved));
                    assert!(specified::force(law.mass.coupling(&mass, sample.e, sample.moved)) == spec.coupled(&memory, e, moved));
                    cover!(s, spec.coupled(&memory, e, moved) < 0, "pulls");
                }
            }
            divided_property! {
                /// P11, enhanced law: the mass' move that the energy pays for at the wanted force.
                equation "(E', f, d') = spec(E, N0, f_wanted)"
                over "valid configuration, position, drive, wanted force, stored energy"
                by $paid fn p11_move_at_full_force(s) {
                    let (law, series) = such!(s, any_enhanced::<N, S>(s, ObserverForm::Exact), |it| enhanced_ok(&it), "validate");
                    let (from, wanted, stored) = (N::any_position(s), N::any_force(s), N::any_energy(s));
                    let drive = such!(s, N::any_tension(s), |drive| drive_ok(&law.mass, drive), "p6_drive_is_exact");
                    assume!(s, wanted > Force::zero(), "what tick passes: the contact ends otherwise");
                    assume!(s, stored >= Energy::zero() && stored <= law.energy_cap, "invariant, kept by p4_augmenting");
                    let mut left = stored;
                    let (force, step) = law.affordable_move(from, drive, wanted, &mut left);
                    assume!(s, force == wanted, "case; the others are p11_move_held_back and p11_move_pulled_out");
                    let spec = specified::enhanced(&law, specified::gain(series));
                    let memory = specified::EnhancedMemory { energy: specified::energy(stored), mass: position(from), ..Default::default() };
                    let expected = spec.paid_move(&memory, specified::tension(drive), specified::force(wanted));
                    assert!(expected == (specified::energy(left), specified::force(force), position(step)));
                    cover!(s, left < stored, "paid");
                    cover!(s, left > stored, "stored");
                }
            }
            divided_property! {
                /// P11, enhanced law: the mass' move that the energy pays for with less force.
                equation "(E', f, d') = spec(E, N0, f_wanted)"
                over "valid configuration, position, drive, wanted force, stored energy"
                by $paid fn p11_move_held_back(s) {
                    let (law, series) = such!(s, any_enhanced::<N, S>(s, ObserverForm::Exact), |it| enhanced_ok(&it), "validate");
                    let (from, wanted, stored) = (N::any_position(s), N::any_force(s), N::any_energy(s));
                    let drive = such!(s, N::any_tension(s), |drive| drive_ok(&law.mass, drive), "p6_drive_is_exact");
                    assume!(s, wanted > Force::zero(), "what tick passes: the contact ends otherwise");
                    assume!(s, stored >= Energy::zero() && stored <= law.energy_cap, "invariant, kept by p4_augmenting");
                    let mut left = stored;
                    let (force, step) = law.affordable_move(from, drive, wanted, &mut left);
                    assume!(s, force > Force::zero() && force < wanted, "case; the others are p11_move_at_full_force and p11_move_pulled_out");
                    let (full, less, out) = (specified::force(wanted), specified::force(force), -position(step));
                    assume!(
                        s,
                        specified::times(full - less, out) + specified::times(less, out) == specified::times(full, out),
                        "arithmetic, said to the solver"
                    );
                    let spec = specified::enhanced(&law, specified::gain(series));
                    let memory = specified::EnhancedMemory { energy: specified::energy(stored), mass: position(from), ..Default::default() };
                    let expected = spec.paid_move(&memory, specified::tension(drive), specified::force(wanted));
                    assert!(expected == (specified::energy(left), specified::force(force), position(step)));
                    cover!(s, left < stored, "paid");
                    cover!(s, step < Position::zero(), "retreats");
                }
            }
            divided_property! {
                /// P11, enhanced law: the mass is pulled out, without a force.
                equation "(E', f, d') = spec(E, N0, f_wanted)"
                over "valid configuration, position, drive, wanted force, stored energy"
                by $paid fn p11_move_pulled_out(s) {
                    let (law, series) = such!(s, any_enhanced::<N, S>(s, ObserverForm::Exact), |it| enhanced_ok(&it), "validate");
                    let (from, wanted, stored) = (N::any_position(s), N::any_force(s), N::any_energy(s));
                    let drive = such!(s, N::any_tension(s), |drive| drive_ok(&law.mass, drive), "p6_drive_is_exact");
                    assume!(s, wanted > Force::zero(), "what tick passes: the contact ends otherwise");
                    assume!(s, stored >= Energy::zero() && stored <= law.energy_cap, "invariant, kept by p4_augmenting");
                    let mut left = stored;
                    let (force, step) = law.affordable_move(from, drive, wanted, &mut left);
                    assume!(s, force == Force::zero(), "case; the others are p11_move_at_full_force and p11_move_held_back");
                    let spec = specified::enhanced(&law, specified::gain(series));
                    let memory = specified::EnhancedMemory { energy: specified::energy(stored), mass: position(from), ..Default::default() };
                    let expected = spec.paid_move(&memory, specified::tension(drive), specified::force(wanted));
                    assert!(expected == (specified::energy(left), specified::force(force), position(step)));
                    cover!(s, step < Position::zero(), "pulled out");
                }
            }
            multiplied_property! {
                $products
                /// P11, guard: a tick that is neither overspeed nor a deficit: account and force.
                equation "(B', f, f(n-1)') = spec(B, f, g, Δ, f_wanted)"
                over "valid configuration, memory in the invariant, displacement, way before the change, wanted force"
                by $guard fn p11_guard(s) {
                    let law = such!(s, Guard::<N>::any(s), |law| law.valid(), "Guard::new");
                    multiplied::of_memory();
                    let before = such!(
                        s, <Guard<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state) && state.account >= Energy::zero(),
                        "invariant, kept by p1_account_stays and p4_overspeed; case: the others are p11_guard_over and p11_guard_deficit"
                    );
                    let (moved, wanted) = (N::any_position(s), N::any_force(s));
                    assume!(s, moved.modulus() <= law.furthest, "case; the other is p11_guard_over");
                    let mut state = before;
                    multiplied::of_code();
                    let fine = law.tick(&mut state, moved, wanted).is_ok();
                    multiplied::of_specification();
                    let spec = specified::guard(&law);
                    let expected = spec.tick(&specified::of_guard(&before), position(moved), 0, specified::force(wanted));
                    assert!(expected == (specified::of_guard(&state), fine));
                    cover!(s, state.force > Force::zero() && state.force < wanted, "cut");
                    cover!(s, state.account == law.capacity && law.capacity > Energy::zero(), "full");
                }
            }
            multiplied_property! {
                $products
                /// P11, guard: overspeed.
                equation "(B', f, f(n-1)') = spec(B, f, g, Δ, f_wanted)"
                over "valid configuration, memory in the invariant, displacement, wanted force"
                by $ends fn p11_guard_over(s) {
                    let law = such!(s, Guard::<N>::any(s), |law| law.valid(), "Guard::new");
                    multiplied::of_memory();
                    let before = such!(
                        s, <Guard<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p1_account_stays and p4_overspeed"
                    );
                    let (moved, wanted) = (N::any_position(s), N::any_force(s));
                    let over = moved.0 == N::LOWEST || moved.modulus() > law.furthest;
                    assume!(s, over, "case; the others are p11_guard and p11_guard_deficit");
                    let mut state = before;
                    multiplied::of_code();
                    let fine = law.tick(&mut state, moved, wanted).is_ok();
                    multiplied::of_specification();
                    let spec = specified::guard(&law);
                    let expected = spec.tick(&specified::of_guard(&before), position(moved), 0, specified::force(wanted));
                    assert!(expected == (specified::of_guard(&state), fine));
                    cover!(s, !fine && state.account < before.account, "lost");
                    cover!(s, before.account < Energy::zero(), "with a deficit");
                }
            }
            multiplied_property! {
                $products
                /// P11, guard: a deficit.
                equation "(B', f, f(n-1)') = spec(B, f, g, Δ, f_wanted)"
                over "valid configuration, memory in the invariant, displacement, wanted force"
                by $ends fn p11_guard_deficit(s) {
                    let law = such!(s, Guard::<N>::any(s), |law| law.valid(), "Guard::new");
                    multiplied::of_memory();
                    let before = such!(
                        s, <Guard<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p1_account_stays and p4_overspeed"
                    );
                    let (moved, wanted) = (N::any_position(s), N::any_force(s));
                    let over = moved.0 == N::LOWEST || moved.modulus() > law.furthest;
                    assume!(s, !over && before.account < Energy::zero(), "case; the others are p11_guard and p11_guard_over");
                    let mut state = before;
                    multiplied::of_code();
                    let fine = law.tick(&mut state, moved, wanted).is_ok();
                    multiplied::of_specification();
                    let spec = specified::guard(&law);
                    let expected = spec.tick(&specified::of_guard(&before), position(moved), 0, specified::force(wanted));
                    assert!(expected == (specified::of_guard(&state), fine));
                    cover!(s, state.account > before.account, "made up");
                    cover!(s, wanted > Force::zero() && state.account < Energy::zero(), "no force");
                }
            }
        }
    };
}

refines!(
    /// At 8 bits: every case.
    w8, Fixed8, at8, by kissat, spring kissat, thesis kissat, energy kissat, sfa kissat, offset kissat, first cadical, held kissat, rest kissat, forces kissat, paid kissat, whole sampled, guard kissat, ends kissat, products plain
);
refines!(
    /// As shipped: the guard with products of which facts are known, the rest on samples from every memory of the invariant, reachable or not.
    w32, Fixed32, at32, by sampled, spring minisat, thesis sampled, energy sampled, sfa minisat, offset minisat, first sampled, held sampled, rest sampled, forces sampled, paid sampled, whole sampled, guard minisat, ends minisat, products multiplied
);
