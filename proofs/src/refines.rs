//! P11 (refinement): a tick of the code is a tick of its specification, force and whole memory, to the last bit.
//!
//! The specification, in `spec/`, uses no `Number` and shares nothing with the code. At 32 bits the model checker compares code and
//! specification for every configuration, memory and sample. Products, quotients and roots are known only by facts
//! (`multiplied.rs`, `divided.rs`). The same bodies run in random tests at 8 bits as well, and `proofs/tests/spec_*.rs` compare
//! millions of ticks.
//!
//! ```text
//! tick(state, e, Δe) = spec(state, e, Δe)     p11_*
//! ```
//!
//! The properties of the enhanced law are in [`crate::refines_enhanced`].

use crate::format::Format;
use crate::source::Source;
use crate::valid::Valid;
use crate::{
    assume, booked_property, cover, divided_property, multiplied, multiplied_property, such,
};
use touchstone_control::law::{Contact, Fba, Law, Sample, Sfa, Spring, Tdpa};
use touchstone_control::{
    Compliance, Energy, Fixed8, Fixed32, Force, Guard, Number, ObserverForm, Position, Ratio,
    Stiffness,
};

/// Input of a law with any position and any displacement.
pub fn any_sample<N: Format, S: Source>(s: &mut S) -> Sample<N> {
    Sample {
        e: N::any_position(s),
        moved: N::any_position(s),
    }
}

macro_rules! refines {
    ($(#[doc = $doc:literal])* $module:ident, $number:ident, $at:ident, by $solver:ident, products $products:ident) => {
        $(#[doc = $doc])*
        pub mod $module {
            use super::*;
            use crate::specified::$at as specified;
            use specified::position;
            type N = $number;

            multiplied_property! {
                $products
                /// P11 (refinement): the tick of a spring with damping equals its specification.
                equation "f = spec(e, Δe), inside' = (e > 0)"
                over "valid configuration, sample"
                by $solver fn p11_spring(s) {
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
            divided_property! {
                $products
                /// P11 (refinement): the thesis' passivity controller (energy and force for a displacement that is already known)
                /// equals its specification.
                equation "(E', f) = spec(E, f_wanted, d)"
                over "stored energy, wanted force not negative, displacement"
                by $solver fn p11_passive(s) {
                    let (stored, wanted, moved) = (N::any_energy(s), N::any_force(s), N::any_position(s));
                    assume!(s, stored >= Energy::zero() && stored <= N::energy_cap(), "invariant, kept by p1_thesis_* and p4_augmenting");
                    assume!(s, wanted >= Force::zero(), "a spring's force outwards");
                    multiplied::of_code();
                    let (energy, force) = N::passivity_step(stored.0, wanted.0, moved.0);
                    multiplied::of_specification();
                    let expected = specified::passive(specified::energy(stored), specified::force(wanted), position(moved), specified::ENERGY_CAP);
                    assert!((specified::energy(Energy(energy).min(N::energy_cap())), specified::force(Force(force))) == expected);
                    cover!(s, expected.1 < specified::force(wanted), "held back");
                    cover!(s, expected.0 > specified::energy(stored), "stored");
                }
            }
            divided_property! {
                $products
                /// P11 (refinement): the tick of TDPA (time-domain passivity) with the thesis' observer, inside the wall, equals
                /// its specification.
                equation "(E', f) = spec(E, e, Δe)"
                over "valid configuration, memory in the invariant, sample inside"
                by $solver fn p11_tdpa_thesis(s) {
                    let law = such!(s, Tdpa { observer: ObserverForm::Thesis, ..Tdpa::<N>::any(s) }, |law| law.valid(), "validate");
                    let before = such!(s, <Tdpa<N> as Valid<N>>::any_state(s), |state| law.holds(&state), "invariant, kept by p4_*");
                    let sample = any_sample::<N, S>(s);
                    assume!(s, sample.e > Position::zero(), "case; outside is tdpa::p7_leaves");
                    let mut state = before;
                    multiplied::of_code();
                    let force = specified::force(law.tick(&mut state, sample));
                    multiplied::of_specification();
                    let spec = specified::tdpa(&law);
                    let expected = spec.tick(&specified::of_tdpa(&before), position(sample.e), position(sample.moved));
                    assert!(expected == (specified::of_tdpa(&state), force));
                    cover!(s, state.force > Force::zero() && expected.0.energy == 0, "spent");
                    cover!(s, state.energy > before.energy, "stored");
                }
            }
            divided_property! {
                $products
                /// P11 (refinement): the energy of TDPA (time-domain passivity) with the exact observer, inside the wall, equals
                /// its specification.
                equation "E' = spec(E, e, Δe)"
                over "valid configuration, memory in the invariant, sample inside"
                by $solver fn p11_tdpa_exact_energy(s) {
                    let law = such!(s, Tdpa { observer: ObserverForm::Exact, ..Tdpa::<N>::any(s) }, |law| law.valid(), "validate");
                    let before = such!(s, <Tdpa<N> as Valid<N>>::any_state(s), |state| law.holds(&state), "invariant, kept by p4_*");
                    let sample = any_sample::<N, S>(s);
                    assume!(s, sample.e > Position::zero(), "case; outside is tdpa::p7_leaves");
                    let mut state = before;
                    multiplied::of_code();
                    let _ = law.tick(&mut state, sample);
                    multiplied::of_specification();
                    let spec = specified::tdpa(&law);
                    let expected = spec.tick(&specified::of_tdpa(&before), position(sample.e), position(sample.moved));
                    assert!(expected.0.energy == specified::energy(state.energy) && state.inside);
                    cover!(s, state.energy < Energy::zero(), "deficit");
                    cover!(s, state.energy == law.energy_cap, "cap");
                }
            }
            divided_property! {
                $products
                /// P11 (refinement): the force of TDPA (time-domain passivity) with the exact observer, inside the wall, equals its
                /// specification.
                equation "f = spec(E, e, Δe)"
                over "valid configuration, memory in the invariant, sample inside"
                by $solver fn p11_tdpa_exact_force(s) {
                    let law = such!(s, Tdpa { observer: ObserverForm::Exact, ..Tdpa::<N>::any(s) }, |law| law.valid(), "validate");
                    let before = such!(s, <Tdpa<N> as Valid<N>>::any_state(s), |state| law.holds(&state), "invariant, kept by p4_*");
                    let sample = any_sample::<N, S>(s);
                    assume!(s, sample.e > Position::zero(), "case; outside is tdpa::p7_leaves");
                    let mut state = before;
                    multiplied::of_code();
                    let force = law.tick(&mut state, sample);
                    multiplied::of_specification();
                    let spec = specified::tdpa(&law);
                    let expected = spec.tick(&specified::of_tdpa(&before), position(sample.e), position(sample.moved));
                    assert!(expected.1 == specified::force(force) && state.force == force);
                    cover!(s, force < Force::zero(), "pulls");
                    cover!(s, force > Force::zero() && force < law.limit, "between");
                }
            }
            divided_property! {
                $products
                /// P11 (refinement): the tick of force bounding, inside the wall, equals its specification. The factor of the force
                /// bound is the one that `Controller::new` calculates from the damping.
                equation "(E', f) = spec(E, f(n-1), e, Δe)"
                over "valid configuration, memory in the invariant, sample inside"
                by $solver fn p11_fba(s) {
                    let law = such!(s, Fba::<N>::any(s), |law| law.valid(), "validate");
                    let law = Fba { bound: Stiffness(N::root_of_four(law.device_damping.0)), ..law };
                    let before = such!(s, <Fba<N> as Valid<N>>::any_state(s), |state| law.holds(&state), "invariant, kept by p4_*");
                    let sample = any_sample::<N, S>(s);
                    assume!(s, sample.e > Position::zero(), "case; outside is fba::p7_leaves");
                    let mut state = before;
                    multiplied::of_code();
                    let force = specified::force(law.tick(&mut state, sample));
                    multiplied::of_specification();
                    let spec = specified::fba(&law);
                    let expected = spec.tick(&specified::of_fba(&before), position(sample.e), position(sample.moved));
                    assert!(expected == (specified::of_fba(&state), force));
                    cover!(s, expected.0.energy < 0, "deficit");
                    cover!(s, force > 0 && force < specified::force(law.limit), "bounded");
                }
            }
            multiplied_property! {
                $products
                /// P11 (refinement): the tick of SFA (successive force augmentation), original and continuous, equals its
                /// specification from every memory.
                equation "(memory', f) = spec(memory, e, Δe)"
                over "valid configuration with a limit above 0 and ratios not negative, memory in the invariant, sample"
                by $solver fn p11_sfa(s) {
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
            multiplied_property! {
                $products
                /// P11 (refinement), guard: the sum of the energy account equals its specification, with a position that was read
                /// when the force changed.
                equation "B' = spec(B, f, g, Δ, Δ_before)"
                over "valid configuration, memory in the invariant, displacement, way before the change, wanted force"
                by $solver fn p11_guard_booked(s) {
                    let law = such!(s, Guard::<N>::any(s), |law| law.valid(), "Guard::new");
                    multiplied::of_memory();
                    let before = such!(
                        s, <Guard<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state) && state.account >= Energy::zero(),
                        "invariant, kept by p1_account_stays and p4_overspeed; case: the others are p11_guard_over and p11_guard_deficit"
                    );
                    let (moved, before_change) = (N::any_position(s), N::any_position(s));
                    assume!(s, moved.modulus() <= law.furthest && before_change.modulus() <= law.furthest, "case; the other is p11_guard_over");
                    multiplied::of_code();
                    let booked = law.booked(&before, moved, moved.modulus(), before_change);
                    multiplied::of_specification();
                    let spec = specified::guard(&law);
                    let expected = spec.booked(&specified::of_guard(&before), position(moved), position(before_change));
                    assert!(specified::energy(booked) == expected && expected >= -specified::ENERGY_CAP);
                    cover!(s, booked < before.account, "paid");
                    cover!(s, booked > before.account && before_change != moved, "taken");
                }
            }
            booked_property! {
                $products
                /// P11 (refinement), guard: energy account and force equal the specification's in a tick without overspeed and
                /// without an energy deficit.
                equation "(B', f, f(n-1)') = spec(B, f, g, Δ, Δ_before, f_wanted)"
                over "valid configuration, memory in the invariant, displacement, way before the change, wanted force"
                by $solver fn p11_guard(s) {
                    let law = such!(s, Guard::<N>::any(s), |law| law.valid(), "Guard::new");
                    multiplied::of_memory();
                    let before = such!(
                        s, <Guard<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state) && state.account >= Energy::zero(),
                        "invariant, kept by p1_account_stays and p4_overspeed; case: the others are p11_guard_over and p11_guard_deficit"
                    );
                    let (moved, before_change, wanted) = (N::any_position(s), N::any_position(s), N::any_force(s));
                    assume!(s, moved.modulus() <= law.furthest && before_change.modulus() <= law.furthest, "case; the other is p11_guard_over");
                    let mut state = before;
                    multiplied::of_code();
                    let fine = law.tick_with_change(&mut state, moved, before_change, wanted).is_ok();
                    multiplied::of_specification();
                    let spec = specified::guard(&law);
                    let expected = spec.tick(&specified::of_guard(&before), position(moved), position(before_change), specified::force(wanted));
                    assert!(expected == (specified::of_guard(&state), fine));
                    cover!(s, state.force > Force::zero() && state.force < wanted, "cut");
                    cover!(s, state.account == law.capacity && law.capacity > Energy::zero(), "full");
                }
            }
            booked_property! {
                $products
                /// P11 (refinement), guard: a tick with overspeed equals its specification.
                equation "(B', f, f(n-1)') = spec(B, f, g, Δ, Δ_before, f_wanted)"
                over "valid configuration, memory in the invariant, displacement, way before the change, wanted force"
                by $solver fn p11_guard_over(s) {
                    let law = such!(s, Guard::<N>::any(s), |law| law.valid(), "Guard::new");
                    multiplied::of_memory();
                    let before = such!(
                        s, <Guard<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p1_account_stays and p4_overspeed"
                    );
                    let (moved, before_change, wanted) = (N::any_position(s), N::any_position(s), N::any_force(s));
                    let over = [moved, before_change].map(|way| way.0 == N::LOWEST || way.modulus() > law.furthest);
                    assume!(s, over[0] || over[1], "case; the others are p11_guard and p11_guard_deficit");
                    let mut state = before;
                    multiplied::of_code();
                    let fine = law.tick_with_change(&mut state, moved, before_change, wanted).is_ok();
                    multiplied::of_specification();
                    let spec = specified::guard(&law);
                    let expected = spec.tick(&specified::of_guard(&before), position(moved), position(before_change), specified::force(wanted));
                    assert!(expected == (specified::of_guard(&state), fine));
                    cover!(s, !fine && state.account < before.account, "lost");
                    cover!(s, before.account < Energy::zero(), "with a deficit");
                }
            }
            booked_property! {
                $products
                /// P11 (refinement), guard: a tick in which the energy account has a deficit equals its specification.
                equation "(B', f, f(n-1)') = spec(B, f, g, Δ, Δ_before, f_wanted)"
                over "valid configuration, memory in the invariant, displacement, way before the change, wanted force"
                by $solver fn p11_guard_deficit(s) {
                    let law = such!(s, Guard::<N>::any(s), |law| law.valid(), "Guard::new");
                    multiplied::of_memory();
                    let before = such!(
                        s, <Guard<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p1_account_stays and p4_overspeed"
                    );
                    let (moved, before_change, wanted) = (N::any_position(s), N::any_position(s), N::any_force(s));
                    let over = [moved, before_change].map(|way| way.0 == N::LOWEST || way.modulus() > law.furthest);
                    assume!(s, !over[0] && !over[1] && before.account < Energy::zero(), "case; the others are p11_guard and p11_guard_over");
                    let mut state = before;
                    multiplied::of_code();
                    let fine = law.tick_with_change(&mut state, moved, before_change, wanted).is_ok();
                    multiplied::of_specification();
                    let spec = specified::guard(&law);
                    let expected = spec.tick(&specified::of_guard(&before), position(moved), position(before_change), specified::force(wanted));
                    assert!(expected == (specified::of_guard(&state), fine));
                    cover!(s, state.account > before.account, "made up");
                    cover!(s, wanted > Force::zero() && state.account < Energy::zero(), "no force");
                }
            }
            booked_property! {
                $products
                /// P11 (refinement), guard: the guard's memory after the force was switched off equals its specification.
                equation "(B', f', f(n-1)') = spec(B, f, f(n-1))"
                over "valid configuration, memory in the invariant"
                by $solver fn p11_guard_switched_off(s) {
                    let law = such!(s, Guard::<N>::any(s), |law| law.valid(), "Guard::new");
                    multiplied::of_memory();
                    let before = such!(
                        s, <Guard<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p1_account_stays and p4_overspeed"
                    );
                    let mut state = before;
                    multiplied::of_code();
                    law.switched_off(&mut state);
                    multiplied::of_specification();
                    let expected = specified::guard(&law).switched_off(&specified::of_guard(&before));
                    assert!(expected == specified::of_guard(&state));
                    cover!(s, state.account < before.account && before.force == Force::zero(), "the older force acts on");
                    cover!(s, state.account == Energy::zero() && before.account > Energy::zero(), "nobody knows how long it acted");
                    cover!(s, state.account < Energy::zero(), "with a deficit");
                }
            }
            booked_property! {
                $products
                /// P11 (refinement), guard: a tick without a measured position at the change of force equals a tick in which the
                /// device did not move before that change.
                equation "tick(Δ) = tick(Δ, 0)"
                over "valid configuration, memory in the invariant, displacement, wanted force"
                by $solver fn p11_guard_without_change(s) {
                    let law = such!(s, Guard::<N>::any(s), |law| law.valid(), "Guard::new");
                    multiplied::of_memory();
                    let before = such!(
                        s, <Guard<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p1_account_stays and p4_overspeed"
                    );
                    let (moved, wanted) = (N::any_position(s), N::any_force(s));
                    let (mut state, mut other) = (before, before);
                    multiplied::of_code();
                    let found = law.tick(&mut state, moved, wanted);
                    multiplied::of_specification();
                    let expected = law.tick_with_change(&mut other, moved, Position::zero(), wanted);
                    assert!(found == expected && state == other);
                    cover!(s, found.is_err(), "overspeed");
                    cover!(s, found.is_ok_and(|force| force > Force::zero()), "a force");
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
