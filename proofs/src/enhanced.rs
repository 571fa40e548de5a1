//! Properties of the enhanced law (successive force augmentation) and its virtual mass.

use crate::facts::Facts32;
use crate::format::Format;
use crate::functions::Functions32;
use crate::valid::{Valid, any_mass, drive_ok, mass_ok};
use crate::{assume, cover, property, such};
use touchstone_control::filter::MassState;
use touchstone_control::law::{Contact, EnhancedSfa, EnhancedState, Law, Sample};
use touchstone_control::{
    Energy, FirstContact, Fixed8, Force, Number, ObserverForm, Position, Stiffness,
};

macro_rules! enhanced {
    ($(#[doc = $doc:literal])* $module:ident, $number:ident, functions $functions:ident, by $solver:ident, sums $sums:ident, books $books:ident) => {
        $(#[doc = $doc])*
        pub mod $module {
            use super::*;
            type N = $number;
            type F = $functions;

            property! {
                /// P1 (energy) at the virtual mass: for every driving force and every position of the mass, the stored energy stays
                /// between 0 and its cap, and the force between 0 and the requested one.
                equation "0 <= E' <= cap, 0 <= f <= f_wanted"
                over "valid configuration, position, drive, wanted force, stored energy"
                by $solver fn p1_energy_stays(s) {
                    let law = such!(s, EnhancedSfa::<N>::any(s), |law| law.valid(), "validate");
                    let from = N::any_position(s);
                    let drive = such!(s, N::any_tension(s), |drive| drive_ok(&law.mass, drive), "p6_drive_is_exact");
                    let (wanted, before) = (N::any_force(s), N::any_energy(s));
                    assume!(s, wanted > Force::zero(), "what tick passes: the contact ends otherwise");
                    assume!(s, before >= Energy::zero() && before <= law.energy_cap, "invariant, kept by p4_augmenting");
                    let mut energy = before;
                    let (force, step) = law.affordable_move(from, drive, wanted, &mut energy);
                    assert!(energy >= Energy::zero());
                    assert!(energy <= law.energy_cap);
                    assert!(force >= Force::zero() && force <= wanted);
                    cover!(s, force > Force::zero() && force < wanted && step < Position::zero(), "retreat limited");
                    cover!(s, force == Force::zero() && step < Position::zero(), "pulled out without the wall's help");
                    cover!(s, force == wanted && step < Position::zero() && energy < before, "paid in full");
                    cover!(s, energy == law.energy_cap && energy > before, "cap reached");
                    cover!(s, before == Energy::zero() && step == Position::zero(), "holds without energy");
                }
            }
            property! {
                /// P1 (energy) at the virtual mass: the mass moves by exactly the displacement whose energy is counted. The new
                /// energy is the energy before plus force times displacement, at most the cap. If the outward motion is limited,
                /// the new energy is the remainder of the division plus what the smaller force saves.
                equation "E' = E + f d', at most the cap, or E' = rest + (f_wanted - f) m with d' = -m"
                over "valid configuration, position, drive, wanted force, stored energy"
                by $books fn p1_books_are_right(s) {
                    let law = such!(s, EnhancedSfa::<F>::any(s), |law| law.valid(), "validate");
                    let from = F::any_position(s);
                    let drive = such!(s, F::any_tension(s), |drive| drive_ok(&law.mass, drive), "p6_drive_is_exact");
                    let (wanted, before) = (F::any_force(s), F::any_energy(s));
                    assume!(s, wanted > Force::zero(), "what tick passes: the contact ends otherwise");
                    assume!(s, before >= Energy::zero() && before <= law.energy_cap, "invariant, kept by p4_augmenting");
                    let mut energy = before;
                    let (force, step) = law.affordable_move(from, drive, wanted, &mut energy);
                    let (retreat, rest) = before.affordable(wanted);
                    let full = (before + force * step).min(law.energy_cap);
                    let limited = (rest + (wanted - force) * retreat).min(law.energy_cap);
                    assert!(energy == full || (energy == limited && step == -retreat));
                    cover!(s, energy == limited && force > Force::zero() && force < wanted && retreat > Position::zero(), "retreat limited");
                }
            }
            property! {
                /// P1 (energy) at the virtual mass: it moves by exactly the displacement whose energy was counted, also at the end
                /// of the range of positions.
                equation "x + d' = x + d' without saturation"
                over "valid mass, position, drive, force"
                by $solver fn p1_displacement_is_real(s) {
                    let mass = such!(s, any_mass::<N, _>(s), |mass| mass_ok(&mass), "validate");
                    let (from, force) = (N::any_position(s), N::any_force(s));
                    let drive = such!(s, N::any_tension(s), |drive| drive_ok(&mass, drive), "p6_drive_is_exact");
                    let step = mass.displacement(from, drive, force);
                    assert!(N::of_signal((from + step).0) == N::of_signal(from.0) + N::of_signal(step.0));
                    cover!(s, (from + step).0 == N::HIGHEST && step > Position::zero(), "end of the range");
                }
            }
            property! {
                /// P6 (virtual mass): rounding only dissipates. The displacement has the sign of the net force and never exceeds
                /// the exact quotient of net force and stored sum of coefficients. This uses `heart::p6_quotient` and that the
                /// reciprocal is exact.
                equation "|d'| <= |(N0 - f) / D|, sign of N0 - f"
                over "valid mass, position, drive, force"
                by $sums fn p6_rounding_dissipates(s) {
                    let mass = such!(s, any_mass::<F, _>(s), |mass| mass_ok(&mass), "validate");
                    let (from, force) = (F::any_position(s), F::any_force(s));
                    let drive = such!(s, F::any_tension(s), |drive| drive_ok(&mass, drive), "p6_drive_is_exact");
                    let step = mass.displacement(from, drive, force);
                    let net = drive - force.lift();
                    let quotient = net.per(&mass.by_total);
                    assert!(F::of_signal(step.0).unsigned_abs() <= F::of_signal(quotient.0).unsigned_abs());
                    assert!(step == Position::zero() || (step > Position::zero()) == (net.0 > 0));
                    cover!(s, step < Position::zero() && step > quotient, "stopped by the end of the range");
                    cover!(s, step == quotient && step < Position::zero(), "free");
                }
            }
            property! {
                /// P6 (virtual mass): the sum of products that drives the virtual mass (inertia, coupling spring, coupling damper)
                /// cannot saturate: it is the exact sum.
                equation "|M d + k_f s + C Δe| <= D 2^31 (2^7 at 8 bits)"
                over "valid mass, its state, position, displacement"
                by $solver fn p6_drive_is_exact(s) {
                    let mass = such!(s, any_mass::<N, _>(s), |mass| mass_ok(&mass), "validate");
                    let state = MassState { position: N::any_position(s), moved: N::any_position(s) };
                    let (e, moved) = (N::any_position(s), N::any_position(s));
                    let drive = mass.drive(&state, e, moved);
                    assert!(drive_ok(&mass, drive));
                    cover!(s, drive.0 < 0, "outward");
                }
            }
            property! {
                /// P6 (virtual mass): with the force that allows an outward displacement, the virtual mass moves out no further
                /// than the forces on it demand.
                equation "f 2^b >= N0 + D m, or f is the largest"
                over "valid mass, drive, retreat >= 0"
                by $sums fn p6_retreat_dissipates(s) {
                    let mass = such!(s, any_mass::<F, _>(s), |mass| mass_ok(&mass), "validate");
                    let drive = such!(s, F::any_tension(s), |drive| drive_ok(&mass, drive), "p6_drive_is_exact");
                    let out = F::any_position(s);
                    assume!(s, out >= Position::zero(), "what affordable_move passes: fact Moved");
                    let force = mass.force_for_retreat(drive, out);
                    assert!(force.0 == F::HIGHEST || force.lift() >= drive + mass.total * out);
                    cover!(s, force > Force::zero() && out > Position::zero() && force.0 < F::HIGHEST, "holds back");
                }
            }
            property! {
                /// P6 (virtual mass): the stored energy of the coupling spring is never understated: the force from which it is
                /// calculated is at least stiffness times stretch.
                equation "2 E_s >= (k_f s rounded up) s"
                over "valid mass, stretch"
                by $sums fn p6_stored_is_enough(s) {
                    let mass = such!(s, any_mass::<F, _>(s), |mass| mass_ok(&mass), "validate");
                    let stretch = F::any_position(s);
                    let size = stretch.modulus();
                    let tension = mass.stiffness * size;
                    match mass.stored(stretch) {
                        Some(stored) => {
                            let force = tension.rounded_up();
                            assert!(force.lift() >= tension);
                            assert!(stored >= Energy::zero());
                            assert_reached!(stored == Energy(F::half_energy_up((force * size).0)));
                        }
                        None => assert_reached!(tension > Force::<F>(F::HIGHEST).lift()),
                    }
                    cover!(s, mass.stored(stretch).is_none(), "beyond the format");
                    cover!(s, mass.stored(stretch).is_some_and(|e| e > Energy::zero()), "stored");
                }
            }
            property! {
                /// P2 (offset): the offset of the soft spring is never negative. It changes by at most the step, in the direction
                /// of the target stiffness.
                equation "O' >= 0"
                over "valid configuration, memory in the invariant, position"
                by $solver fn p2_offset(s) {
                    let law = such!(s, EnhancedSfa::<N>::any(s), |law| law.valid(), "validate");
                    let state = such!(
                        s, <EnhancedSfa<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p4_*"
                    );
                    let e = N::any_position(s);
                    assume!(s, state.contact == Contact::Augmenting, "case; the offset is changed in no other");
                    let before = state.augmented.offset;
                    let after = law.offset(&state, e);
                    assert!(after >= Position::zero());
                    cover!(s, after > before, "grows");
                    cover!(s, after == Position::zero() && before > Position::zero(), "shrinks to nothing");
                }
            }
            property! {
                /// P1 (energy), hand-over at the first reversal of motion: the virtual mass starts with no more energy than the
                /// contact has. The coupling's stored energy is subtracted. If the contact's energy does not cover it, the mass
                /// starts without a stretch. The mass' energy is not negative.
                equation "0 <= E' <= max(E, 0)"
                over "valid configuration, memory at the end of a first contact, any energy up to the cap"
                by $solver fn p1_hand_over(s) {
                    let law = such!(s, EnhancedSfa::<N>::any(s), |law| law.valid(), "validate");
                    let mut state = such!(
                        s, <EnhancedSfa<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state) && state.contact == Contact::First,
                        "invariant, kept by p4_first_contact"
                    );
                                        // The last outward displacement has happened; it may have cost more than was stored.
                    state.energy = N::any_energy(s);
                    assume!(s, state.energy <= law.energy_cap, "what tick passes: capped in the line before");
                    let before = state.energy;
                    law.hand_over(&mut state);
                    assert!(law.holds(&state) && state.contact == Contact::Augmenting);
                    assert!(state.energy <= before.max(Energy::zero()));
                    cover!(s, before < Energy::zero() && state.energy == Energy::zero(), "a deficit is forgiven");
                    cover!(s, state.energy < before && law.first_contact == FirstContact::KeepForce, "stretch covered");
                }
            }
            property! {
                /// P3, P4 and the invariant, before the first reversal of motion: no panic, the force never pulls and is at most
                /// the limit, the invariant is kept. Without a damper the result is the wall's force.
                equation "0 <= f <= limit, 0 <= E <= cap, B = 0 => f = f_wall"
                over "valid configuration, memory in the invariant, position"
                by $solver fn p4_first_contact(s) {
                    let law = such!(s, EnhancedSfa::<N>::any(s), |law| law.valid(), "validate");
                    let before = such!(
                        s, <EnhancedSfa<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p4_*"
                    );
                    let e = N::any_position(s);
                    let sample = Sample { e, moved: N::any_position(s) };
                    assume!(
                        s,
                        before.contact == Contact::Free || (before.contact == Contact::First && (sample.moved >= Position::zero() || e <= Position::zero())),
                        "case; the end of the first contact is p1_hand_over"
                    );
                    let mut state = before;
                    let force = law.tick(&mut state, sample);
                    assert!(law.holds(&state) && state.contact != Contact::Augmenting);
                    assert!(force >= Force::zero() && force <= law.limit);
                    assert!(force == state.force || law.damper != Stiffness::zero());
                    cover!(s, force == law.limit && force > Force::zero(), "limit reached");
                    cover!(s, force > state.force, "damped");
                    cover!(s, before.contact == Contact::First && state.contact == Contact::First && state.energy > before.energy, "absorbs");
                }
            }
            property! {
                /// P3, P4 and the invariant, after the first reversal of motion: no panic, the force never pulls and is at most the
                /// limit, and the stored energy stays at least 0.
                equation "0 <= f <= limit, 0 <= E <= cap, O >= 0"
                over "valid configuration, memory in the invariant, position"
                by $solver fn p4_augmenting(s) {
                    let law = such!(s, EnhancedSfa::<N>::any(s), |law| law.valid(), "validate");
                    let before = such!(
                        s, <EnhancedSfa<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p4_*"
                    );
                    let e = N::any_position(s);
                    let sample = Sample { e, moved: N::any_position(s) };
                    assume!(s, before.contact == Contact::Augmenting, "case; the others are p4_first_contact");
                    let mut state = before;
                    let force = law.tick(&mut state, sample);
                    assert!(law.holds(&state));
                    assert!(force >= Force::zero() && force <= law.limit);
                    cover!(s, law.observer == ObserverForm::Exact && state.energy < before.energy && state.contact == Contact::Augmenting, "pays");
                    cover!(s, e < Position::zero() && force > Force::zero(), "pushes outside the undeformed wall");
                    cover!(s, force == Force::zero() && state.contact == Contact::Augmenting, "left behind");
                    cover!(s, force == law.limit && force > Force::zero(), "limit reached");
                }
            }
            property! {
                /// P7 (end of contact): whenever the contact ends, the force is 0 and the law keeps only the position.
                equation "contact' = none  =>  f = 0, memory cleared"
                over "valid configuration, memory in the invariant, position"
                by $solver fn p7_leaves(s) {
                    let law = such!(s, EnhancedSfa::<N>::any(s), |law| law.valid(), "validate");
                    let before = such!(
                        s, <EnhancedSfa<N> as Valid<N>>::any_state(s),
                        |state| law.holds(&state),
                        "invariant, kept by p4_*"
                    );
                    let e = N::any_position(s);
                    let sample = Sample { e, moved: N::any_position(s) };
                    let mut state = before;
                    let force = law.tick(&mut state, sample);
                    assert!(state.last == e);
                    if state.contact == Contact::Free {
                        assert!(force == Force::zero());
                        assert_reached!(state == EnhancedState { last: e, ..EnhancedState::default() });
                    }
                    // In the first contact phase the surface is that of the undeformed wall.
                    assert!(before.contact == Contact::Augmenting || e > Position::zero() || state.contact == Contact::Free);
                    cover!(s, before.contact == Contact::Augmenting && state.contact == Contact::Free, "leaves");
                }
            }
        }
    };
}

enhanced!(
    /// The properties of this file at 32 bits, the width of the firmware. Of products, quotients and roots only the facts of
    /// [`crate::facts`] are used.
    w32, Facts32, functions Functions32, by cadical, sums cadical, books cadical
);
enhanced!(
    /// The properties of this file at 8 bits, where the model checker refutes wrong changes of the code quickly.
    w8, Fixed8, functions Fixed8, by cadical, sums cadical, books sampled
);
