//! Tests that every shipped law and its specification agree bit for bit, in force and whole memory. The tests run millions of ticks
//! of random and hostile motions, for settings of every size that `AnyLaw::new` accepts.

use fixed::types::{I8F24, I16F48};
use touchstone_control::filter::MassState;
use touchstone_control::law::{Augmented, Contact, EnhancedState, Law as _, Sample};
use touchstone_control::{
    AnyLaw, Energy, Fixed32, LawKind, ObserverForm, OffsetUpdate, Position, Settings,
};
use touchstone_proofs::spec::hands::{Hand, Random, any_law};
use touchstone_proofs::spec::{enhanced, sfa};
use touchstone_proofs::specified::at32;

const TICKS: u64 = 1_500_000;

fn wide(x: I8F24) -> i128 {
    i128::from(x.to_bits())
}

/// Runs laws of one type. `compare` makes one tick of code and specification, reports a difference, and returns which situations
/// occurred. Each situation must occur more than 50 times in the run.
fn every_tick<const N: usize>(
    kind: LawKind,
    seed: u64,
    mut compare: impl FnMut(&Settings, &mut AnyLaw<Fixed32>, I8F24, I8F24) -> [bool; N],
) {
    let mut random = Random(seed);
    let (mut ticks, mut laws, mut reached) = (0, 0, [0_u64; N]);
    while ticks < TICKS {
        let settings = any_law(&mut random, kind);
        let Ok(mut law) = AnyLaw::<Fixed32>::new(&settings) else {
            continue;
        };
        laws += 1;
        let mut hand = Hand::any(&mut random);
        let mut force = 0;
        for tick in 0..500 {
            ticks += 1;
            let (e, moved) = hand.moves(&mut random, tick, force);
            force = match &law {
                AnyLaw::Enhanced(_, state) => wide(state.force.0),
                AnyLaw::Tdpa(_, state) => wide(state.force.0),
                _ => 0,
            };
            for (count, now) in reached
                .iter_mut()
                .zip(compare(&settings, &mut law, e, moved))
            {
                *count += u64::from(now);
            }
        }
    }
    println!("{kind:?}: {ticks} ticks of {laws} laws, {reached:?}");
    assert!(
        reached.iter().all(|count| *count > 50),
        "{kind:?} {reached:?}"
    );
}

fn sample(e: I8F24, moved: I8F24) -> Sample<Fixed32> {
    Sample {
        e: Position(e),
        moved: Position(moved),
    }
}

#[test]
fn every_tick_of_tdpa_is_its_specification() {
    every_tick(LawKind::Tdpa, 1, |settings, law, e, moved| {
        let AnyLaw::Tdpa(law, state) = law else {
            panic!("{settings:?}")
        };
        let (specified, memory) = (at32::tdpa(law), at32::of_tdpa);
        let before = memory(state);
        let (expected, force) = specified.tick(&before, wide(e), wide(moved));
        let got = law.tick(state, sample(e, moved));
        assert_eq!(
            (memory(state), wide(got.0)),
            (expected, force),
            "{settings:?} {before:?} {e:?} {moved:?}"
        );
        let wanted = wide(e) > 0 && force < specified.limit;
        [
            force < 0,
            force > 0,
            before.inside && !expected.inside,
            expected.energy < 0,
            wanted && !specified.exact,
        ]
    });
}

#[test]
fn every_tick_of_fba_is_its_specification() {
    every_tick(LawKind::Fba, 2, |settings, law, e, moved| {
        let AnyLaw::Fba(law, state) = law else {
            panic!("{settings:?}")
        };
        let (specified, memory) = (at32::fba(law), at32::of_fba);
        assert_eq!(at32::gain(law.bound), specified.bound);
        let before = memory(state);
        let (expected, force) = specified.tick(&before, wide(e), wide(moved));
        let got = law.tick(state, sample(e, moved));
        assert_eq!(
            (memory(state), wide(got.0)),
            (expected, force),
            "{settings:?} {before:?} {e:?} {moved:?}"
        );
        [
            force > 0,
            force > 0 && force < specified.limit,
            before.inside && !expected.inside,
            expected.energy < 0,
        ]
    });
}

#[test]
fn every_tick_of_the_spring_is_its_specification() {
    every_tick(LawKind::SpringDamper, 3, |settings, law, e, moved| {
        let AnyLaw::Spring(law, state) = law else {
            panic!("{settings:?}")
        };
        let (k, b, limit) = (
            at32::gain(law.desired),
            at32::gain(law.damping),
            wide(law.limit.0),
        );
        let force = sfa::spring_tick(k, b, limit, wide(e), wide(moved));
        let got = law.tick(state, sample(e, moved));
        assert_eq!(
            (wide(got.0), state.inside),
            (force, wide(e) > 0),
            "{settings:?} {e:?} {moved:?}"
        );
        [force > 0, force == limit, wide(e) > 0 && force == 0]
    });
}

#[test]
fn every_tick_of_sfa_is_its_specification() {
    for (kind, seed) in [(LawKind::Sfa, 4), (LawKind::SfaContinuous, 5)] {
        every_tick(kind, seed, |settings, law, e, moved| {
            let AnyLaw::Sfa(law, state) = law else {
                panic!("{settings:?}")
            };
            let (specified, memory) = (at32::sfa(law), at32::of_sfa);
            let before = memory(state);
            let (expected, force) = specified.tick(&before, wide(e), wide(moved));
            let got = law.tick(state, sample(e, moved));
            assert_eq!(
                (memory(state), wide(got.0)),
                (expected, force),
                "{settings:?} {before:?} {e:?} {moved:?}"
            );
            let more = before.augmenting && expected.augmenting;
            [
                force > 0,
                more && expected.offset > before.offset,
                more && expected.offset < before.offset,
                before.inside && !expected.inside,
            ]
        });
    }
}

#[test]
fn every_tick_of_the_enhanced_law_is_its_specification() {
    every_tick(LawKind::EnhancedSfa, 6, |settings, law, e, moved| {
        let AnyLaw::Enhanced(law, state) = law else {
            // With a desired stiffness up to `k_v`, the enhanced law is a plain spring.
            return [false; 8];
        };
        // The code's divisors are calculated from the settings, rounded towards zero to a gain's digits.
        let series = i128::from((settings.filter.stiffness + settings.k_soft).to_bits() >> 20);
        let (specified, memory) = (at32::enhanced(law, series), at32::of_enhanced);
        let before = memory(state);
        let (expected, force) = specified.tick(&before, wide(e), wide(moved));
        let got = law.tick(state, sample(e, moved));
        assert_eq!(
            (memory(state), wide(got.0)),
            (expected, force),
            "{settings:?} {law:?}\n{before:?} {e:?} {moved:?}"
        );
        let augmenting = before.contact == enhanced::Contact::Augmenting;
        let stays = augmenting && expected.contact == enhanced::Contact::Augmenting;
        let handed = before.contact == enhanced::Contact::First
            && expected.contact == enhanced::Contact::Augmenting;
        [
            handed && expected.mass != before.last,
            handed && expected.mass == before.last,
            stays && expected.offset > before.offset,
            stays && expected.offset < before.offset,
            // The force is reduced because no more energy is stored.
            stays
                && specified.exact
                && expected.energy < -expected.at_mass * expected.mass_moved
                && expected.at_mass > 0,
            stays && force == 0,
            augmenting && !stays,
            stays && wide(e) < 0 && force > 0,
        ]
    });
}

/// Checks a virtual mass from which the hand's point (HIP) moves away. The mass moves on if its energy covers the motion, exact to
/// the last step of the energy format; otherwise it stands still.
#[test]
fn a_mass_that_is_left_behind_moves_where_its_energy_just_pays() {
    let mut random = Random(7);
    let (mut paid, mut stood) = (0_u32, 0_u32);
    while paid < 200 || stood < 200 {
        let settings = Settings {
            offset_update: OffsetUpdate::Inward,
            ..any_law(&mut random, LawKind::EnhancedSfa)
        };
        let Ok(AnyLaw::Enhanced(law, _)) = AnyLaw::<Fixed32>::new(&settings) else {
            continue;
        };
        if law.observer != ObserverForm::Exact {
            continue;
        }
        let mass = MassState {
            position: Position(I8F24::from_bits(1000 + random.below(1 << 20) as i32)),
            moved: Position(I8F24::from_bits(-(random.below(1 << 16) as i32))),
        };
        let wanted = (law.soft * mass.position).outward();
        let step = law
            .mass
            .displacement(mass.position, law.mass.coast(&mass), wanted);
        let cost = -wide(wanted.0) * wide(step.0);
        if cost <= 0 {
            continue;
        }
        let missing = i128::from(random.below(3)) - 1;
        let energy = I16F48::from_bits((cost - missing) as i64);
        let mut state = EnhancedState {
            contact: Contact::Augmenting,
            energy: Energy(energy),
            augmented: Augmented {
                mass,
                ..Augmented::default()
            },
            ..EnhancedState::default()
        };
        // Just inside, so that the coupling would pull.
        let (e, moved) = (I8F24::DELTA, I8F24::ZERO);
        let series = i128::from((settings.filter.stiffness + settings.k_soft).to_bits() >> 20);
        let specified = at32::enhanced(&law, series);
        let expected = specified.tick(&at32::of_enhanced(&state), wide(e), wide(moved));
        let force = law.tick(&mut state, sample(e, moved));
        let got = (at32::of_enhanced(&state), wide(force.0));
        assert_eq!(got, expected, "{settings:?} {mass:?} {missing}");
        if wide(force.0) == 0 && expected.0.contact == enhanced::Contact::Augmenting {
            paid += u32::from(missing == 0 && expected.0.mass_moved == wide(step.0));
            stood += u32::from(missing == 1 && expected.0.mass_moved == 0);
        }
    }
}
