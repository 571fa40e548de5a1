//! Every shipped law and its specification, bit for bit, force and whole memory: millions of ticks under random and hostile motions, for
//! settings of every size that `AnyLaw::new` accepts.

use fixed::types::I8F24;
use touchstone_control::law::{Contact, Law as _, Sample};
use touchstone_control::{
    AnyLaw, FilterSettings, FirstContact, Fixed32, IdealStep, LawKind, ObserverForm, OffsetUpdate,
    Position, Regulate, Settings, Si, Stiffness,
};
use touchstone_proofs::spec::hands::{Random, bits};
use touchstone_proofs::spec::{enhanced, fba, sfa, tdpa};

const TICKS: u64 = 1_500_000;

fn wide(x: I8F24) -> i128 {
    i128::from(x.to_bits())
}
fn gain(k: Stiffness<Fixed32>) -> i128 {
    i128::from(k.0.to_bits())
}

/// Around a default, or of any size.
fn near(random: &mut Random, default: &str) -> Si {
    let default = Si::from_str(default).expect("a number");
    match random.below(4) {
        0 => Si::ZERO,
        1 => default,
        2 => Si::from_bits((random.any() >> 16 >> random.below(40)).cast_signed()),
        _ => default * Si::from_num(random.below(64)) / 8,
    }
}

fn any_settings(random: &mut Random, law: LawKind) -> Settings {
    let one_of_two = |random: &mut Random| random.below(2) == 0;
    Settings {
        law,
        rate_hz: [100, 1000, 1000, 4000][random.below(4) as usize],
        k_desired: near(random, "5"),
        k_soft: near(random, "4.9"),
        device_damping: near(random, "0.0005"),
        virtual_damping: near(random, "0.0076"),
        observer: if one_of_two(random) {
            ObserverForm::Exact
        } else {
            ObserverForm::Thesis
        },
        count_device_damping: one_of_two(random),
        regulate: [Regulate::Hip, Regulate::Mass, Regulate::MassCompensated]
            [random.below(3) as usize],
        offset_update: [
            OffsetUpdate::EveryTick,
            OffsetUpdate::Inward,
            OffsetUpdate::TurnInward,
        ][random.below(3) as usize],
        ideal_step: if one_of_two(random) {
            IdealStep::Force
        } else {
            IdealStep::Position
        },
        first_contact: if one_of_two(random) {
            FirstContact::KeepForce
        } else {
            FirstContact::ZeroOffset
        },
        step_of_ideal: near(random, "0.21"),
        limit_of_force: near(random, "0.41"),
        limit_of_penetration: near(random, "0.4"),
        energy_credit: near(random, "0.02"),
        force_limit: near(random, "0.5"),
        filter: FilterSettings {
            mass: near(random, "0.00000068"),
            stiffness: near(random, "29.6"),
            damping: near(random, "0.00655"),
            ground_damping: near(random, "0.00356"),
        },
        ..Settings::default()
    }
}

/// Penetration and displacement of the next tick: a press and its release, trembling at the surface, jumps, and now and then a displacement
/// that does not belong to it, as an estimator can tell one.
struct Hand {
    habit: u64,
    at: i64,
}
impl Hand {
    fn next(&mut self, random: &mut Random, tick: u64, force: i128) -> (I8F24, I8F24) {
        let before = self.at;
        let speed = 1_i64 << (self.habit / 8 % 22);
        let step = match self.habit % 8 {
            0 => random.within(speed),
            1 => {
                if tick % 200 < 60 {
                    speed
                } else if tick % 200 < 120 {
                    -speed / 3
                } else {
                    random.within(speed / 4 + 1)
                }
            }
            2 => {
                if force > 1 << 20 {
                    -speed
                } else {
                    speed
                }
            }
            3 => {
                if tick % 4 < 2 {
                    speed
                } else {
                    -speed
                }
            }
            4 => random.signed(31) - self.at,
            5 => {
                if tick % 100 < 50 {
                    speed
                } else {
                    -speed - 1
                }
            }
            6 => random.within(3),
            _ => {
                if self.at > speed * 20 {
                    -speed * 7
                } else {
                    random.within(speed) + speed / 8
                }
            }
        };
        self.at = (self.at + step).clamp(-(1 << 31), (1 << 31) - 1);
        let moved = if random.below(16) == 0 {
            random.signed(31)
        } else {
            self.at - before
        };
        (bits(self.at), bits(moved))
    }
}

/// Runs laws of one kind; `compare` makes one tick of both and says what differs. The counts are of situations that must occur.
fn every_tick<const N: usize>(
    kind: LawKind,
    seed: u64,
    mut compare: impl FnMut(&Settings, &mut AnyLaw<Fixed32>, I8F24, I8F24) -> [bool; N],
) {
    let mut random = Random(seed);
    let (mut ticks, mut laws, mut reached) = (0, 0, [0_u64; N]);
    while ticks < TICKS {
        let settings = any_settings(&mut random, kind);
        let Ok(mut law) = AnyLaw::<Fixed32>::new(&settings) else {
            continue;
        };
        laws += 1;
        let mut hand = Hand {
            habit: random.any() >> 20,
            at: -1000,
        };
        let mut force = 0;
        for tick in 0..500 {
            ticks += 1;
            let (e, moved) = hand.next(&mut random, tick, force);
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
        let specified = tdpa::Tdpa {
            desired: gain(law.desired),
            exact: law.observer == ObserverForm::Exact,
            device_damping: gain(law.device_damping),
            limit: wide(law.limit.0),
            energy_cap: 1 << 62,
        };
        let memory = |state: &touchstone_control::law::TdpaState<Fixed32>| tdpa::Memory {
            force: wide(state.force.0),
            energy: i128::from(state.energy.0.to_bits()),
            inside: state.inside,
        };
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
        let specified = fba::Fba {
            desired: gain(law.desired),
            device_damping: gain(law.device_damping),
            bound: fba::Fba::bound_of(gain(law.device_damping)),
            limit: wide(law.limit.0),
            energy_cap: 1 << 62,
        };
        assert_eq!(gain(law.bound), specified.bound);
        let memory = |state: &touchstone_control::law::FbaState<Fixed32>| fba::Memory {
            force: wide(state.force.0),
            energy: i128::from(state.energy.0.to_bits()),
            inside: state.inside,
        };
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
        let (k, b, limit) = (gain(law.desired), gain(law.damping), wide(law.limit.0));
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
            let specified = sfa::Sfa {
                desired: gain(law.desired),
                soft: gain(law.soft),
                gain: wide(law.gain.0),
                compliance: wide(law.compliance.0),
                update: match law.update {
                    OffsetUpdate::TurnInward => sfa::Update::TurnInward,
                    OffsetUpdate::Inward => sfa::Update::Inward,
                    OffsetUpdate::EveryTick => sfa::Update::EveryTick,
                },
                keep_force: law.first_contact == FirstContact::KeepForce,
                limit: wide(law.limit.0),
            };
            let memory = |state: &touchstone_control::law::SfaState<Fixed32>| sfa::Memory {
                inside: state.contact != Contact::Free,
                augmenting: state.contact == Contact::Augmenting,
                last: wide(state.last.0),
                before_last: wide(state.before_last.0),
                offset: wide(state.offset.0),
                force: wide(state.force.0),
            };
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
            // Below k_v it is a plain spring.
            return [false; 8];
        };
        // The divisors are of the settings themselves, towards zero in the digits of a gain.
        let series = i128::from((settings.filter.stiffness + settings.k_soft).to_bits() >> 20);
        let specified = enhanced::Enhanced {
            desired: gain(law.desired),
            target: gain(law.target),
            soft: gain(law.soft),
            compliance: wide(law.compliance.0),
            of_ideal: wide(law.augmentation.of_ideal.0),
            of_force: wide(law.augmentation.of_force.0),
            of_penetration: wide(law.augmentation.of_penetration.0),
            at_hip: law.regulate == Regulate::Hip,
            every_tick: law.update == OffsetUpdate::EveryTick,
            exact: law.observer == ObserverForm::Exact,
            keep_force: law.first_contact == FirstContact::KeepForce,
            inertia: gain(law.mass.inertia),
            coupling: gain(law.mass.stiffness),
            damping: gain(law.mass.damping),
            total: gain(law.mass.total),
            series,
            credit: i128::from(law.credit.0.to_bits()),
            energy_cap: 1 << 62,
            limit: wide(law.limit.0),
        };
        let memory = |state: &touchstone_control::law::EnhancedState<Fixed32>| enhanced::Memory {
            contact: match state.contact {
                Contact::Free => enhanced::Contact::Free,
                Contact::First => enhanced::Contact::First,
                Contact::Augmenting => enhanced::Contact::Augmenting,
            },
            last: wide(state.last.0),
            force: wide(state.force.0),
            energy: i128::from(state.energy.0.to_bits()),
            mass: wide(state.augmented.mass.position.0),
            mass_moved: wide(state.augmented.mass.moved.0),
            offset: wide(state.augmented.offset.0),
            at_mass: wide(state.augmented.at_mass.0),
        };
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
            // Held back because no more is in store.
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
