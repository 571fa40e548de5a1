//! P8 (settings): accepted settings satisfy everything that the other properties assume, and the first memory satisfies the
//! invariants.
//!
//! Settings are 32.32 fixed-point numbers, and a controller multiplies and divides them in 128 bits, which no solver follows. So
//! the property is split. Conversions to the format are proved for every value (`p8_conversions32`). Every test run builds
//! whole controllers from random settings on both sides of every bound, and checks each against the assumptions.

use crate::facts::Facts32;
use crate::format::Format;
use crate::valid::Valid;
use crate::{cover, property};
use touchstone_control::law::{EnhancedState, FbaState, SfaState, SpringState, TdpaState};
use touchstone_control::{AnyLaw, Controller, Fixed32, Force, Number, Si, Stiffness};

property! {
    /// P8 (settings): a setting keeps its sign, and the absolute value of its bits is shifted to the format, which rounds towards
    /// zero. A setting that must not be negative but is, or that does not fit, is refused.
    equation "bits' = bits >> shift, or refused"
    over "setting of 64 bits"
    by minisat fn p8_conversions32(s) {
        let bits = s.i64();
        let si = Si::from_bits(bits);
        if let Some(gain) = Fixed32::gain(si) {
            assert_reached!(bits >= 0 && i64::from(gain.to_bits()) == bits >> 20);
        } else {
            assert_reached!(bits < 0 || bits >> 20 > i64::from(i32::MAX));
        }
        if let Some(ratio) = Fixed32::ratio(si) {
            assert_reached!(bits >= 0 && i64::from(ratio.to_bits()) == bits >> 8);
        }
        if let Some(signal) = Fixed32::signal(si) {
            assert_reached!(u64::from(signal.to_bits().unsigned_abs()) == bits.unsigned_abs() >> 8);
        }
        if let Some(energy) = Fixed32::energy(si) {
            assert_reached!(energy.to_bits().unsigned_abs() == bits.unsigned_abs() << 16);
        }
        cover!(s, bits < 0 && Fixed32::signal(si).is_some(), "negative signal");
        cover!(s, bits > 0 && Fixed32::gain(si).is_none(), "too stiff");
        cover!(s, Fixed32::energy(si).is_none(), "too much energy");
    }
}

property! {
    /// P8 (settings): the memory with which every law starts satisfies the law's invariant.
    equation "invariant(initial memory)"
    over "configuration; SFA: valid"
    fn p8_initial32(s) {
        type N = Facts32;
        use touchstone_control::law::{EnhancedSfa, Fba, Sfa, Spring, Tdpa};
        let spring = Spring::<N>::any(s);
        assert!(spring.holds(&SpringState::default()));
        let tdpa = Tdpa::<N>::any(s);
        assert!(tdpa.holds(&TdpaState::default()));
        let fba = Fba::<N>::any(s);
        assert!(fba.holds(&FbaState::default()));
        let sfa = Sfa::<N>::any(s);
        assert!(!sfa.valid() || sfa.holds(&SfaState::default()));
        let enhanced = EnhancedSfa::<N>::any(s);
        assert!(enhanced.holds(&EnhancedState::default()));
        cover!(s, sfa.valid(), "valid");
    }
}

/// Whether a controller's coefficients satisfy what the properties assume about its law.
pub fn satisfies_assumptions<N: Format>(controller: &Controller<N>) -> bool {
    let guarded = controller.guard.as_ref();
    if guarded.is_some_and(|it| !(it.guard.valid() && it.guard.holds(&it.state))) {
        return false;
    }
    let pulse = controller.impact.as_ref();
    if pulse.is_some_and(|it| it.brake < Stiffness::zero() || it.limit < Force::zero()) {
        return false;
    }
    match &controller.law {
        AnyLaw::Spring(law, state) => law.valid() && law.holds(state),
        AnyLaw::Damped(law, state) => law.spring.valid() && law.spring.holds(&state.spring),
        AnyLaw::Tdpa(law, state) => {
            law.valid() && law.energy_cap == N::energy_cap() && law.holds(state)
        }
        AnyLaw::Fba(law, state) => {
            let bound = i128::from(N::of_gain(law.bound.0));
            let damping = i128::from(N::of_gain(law.device_damping.0));
            law.valid()
                && law.energy_cap == N::energy_cap()
                && law.holds(state)
                // `bound² <= 4 c_i/T`, as stored.
                && bound * bound <= damping << (N::GAIN_BITS + 2)
        }
        AnyLaw::Sfa(law, state) => law.valid() && law.holds(state),
        AnyLaw::Enhanced(law, state) => {
            law.valid() && law.energy_cap == N::energy_cap() && law.holds(state)
        }
    }
}

#[cfg(all(test, not(kani)))]
mod tests {
    use super::*;
    use crate::source::{Sampler, Source, sample};
    use touchstone_control::{
        ChangeOfForce, Choice as _, EstimatorSettings, Field, FilterSettings, FirstContact, Fixed8,
        Fixed16, GuardSettings, IdealStep, ImpactSettings, LawKind, ObserverForm, OffsetUpdate,
        PositionSettings, Regulate, Settings, SettingsError, States, StatesKind, VelocityKind,
        VelocitySettings,
    };

    fn si(s: &mut Sampler, base: Si) -> Si {
        // A value around a base value, any value, or zero.
        match s.bits(3) {
            0 => Si::from_bits(s.i64()),
            1 => Si::ZERO,
            2 => Si::from_bits(s.i64().rem_euclid(1 << 44)),
            _ => Si::from_bits((base.to_bits() >> s.bits(4)) << s.bits(4).min(8)),
        }
    }

    fn settings(s: &mut Sampler) -> Settings {
        let base = Settings::thesis();
        let pick = |s: &mut Sampler, value: Si| if s.bits(2) == 0 { si(s, value) } else { value };
        Settings {
            law: [
                LawKind::Spring,
                LawKind::SpringDamper,
                LawKind::Tdpa,
                LawKind::Fba,
                LawKind::Sfa,
                LawKind::SfaContinuous,
                LawKind::EnhancedSfa,
                LawKind::EnhancedSfa,
            ][s.bits(3) as usize],
            rate_hz: [1_000, 1, 100_000, s.u32()][s.bits(2) as usize],
            k_desired: pick(s, base.k_desired),
            k_soft: pick(s, base.k_soft),
            device_damping: pick(s, base.device_damping),
            virtual_damping: pick(s, base.virtual_damping),
            observer: [ObserverForm::Exact, ObserverForm::Thesis][s.bits(1) as usize],
            count_device_damping: s.bool(),
            first_contact: [FirstContact::KeepForce, FirstContact::ZeroOffset][s.bits(1) as usize],
            regulate: [
                Regulate::Mass,
                Regulate::MassCompensated,
                Regulate::Hip,
                Regulate::Hip,
            ][s.bits(2) as usize],
            offset_update: [OffsetUpdate::TurnInward, OffsetUpdate::EveryTick][s.bits(1) as usize],
            ideal_step: [IdealStep::Position, IdealStep::Force][s.bits(1) as usize],
            step_of_ideal: pick(s, base.step_of_ideal),
            limit_of_force: pick(s, base.limit_of_force),
            limit_of_penetration: pick(s, base.limit_of_penetration),
            filter: FilterSettings {
                mass: pick(s, base.filter.mass),
                stiffness: pick(s, base.filter.stiffness),
                damping: pick(s, base.filter.damping),
                ground_damping: pick(s, base.filter.ground_damping),
            },
            energy_credit: pick(s, base.energy_credit),
            force_limit: pick(s, base.force_limit),
            position_error: pick(s, Si::lit("0.01")),
            states: [StatesKind::Measured, StatesKind::Estimated][s.bits(1) as usize],
            estimator: EstimatorSettings {
                bandwidth_hz: pick(s, base.estimator.bandwidth_hz),
                inertia: pick(s, base.estimator.inertia),
                damping: pick(s, base.estimator.damping),
                delay_s: pick(s, base.estimator.delay_s),
            },
            guard: GuardSettings {
                on: s.bool(),
                capacity: pick(s, base.guard.capacity),
                refill: pick(s, base.guard.refill),
                damping: pick(s, base.guard.damping),
                share_of_damping: pick(s, base.guard.share_of_damping),
                overspeed: pick(s, base.guard.overspeed),
                delay: pick(s, base.guard.delay),
                lag: pick(s, base.guard.lag),
                change: [ChangeOfForce::Estimated, ChangeOfForce::Measured][s.bits(1) as usize],
            },
            velocity: VelocitySettings {
                from: VelocityKind::ALL[s.bits(3) as usize % VelocityKind::ALL.len()],
                bandwidth_hz: pick(s, base.velocity.bandwidth_hz),
                window_s: pick(s, base.velocity.window_s),
            },
            impact: ImpactSettings {
                momentum: pick(s, Si::ONE),
                vibration: pick(s, Si::ONE),
                frequency_hz: pick(s, base.impact.frequency_hz),
                decay_s: pick(s, base.impact.decay_s),
            },
            position: PositionSettings::of_counts_per_rev(s.u32() >> s.bits(5)),
        }
    }

    #[test]
    fn p8_whatever_is_accepted_satisfies_the_assumptions() {
        fn body(s: &mut Sampler) {
            let settings = settings(s);
            let built = Controller::<Fixed32>::new(&settings);
            if let Ok(controller) = &built {
                assert!(settings.validate().is_ok());
                assert!(
                    satisfies_assumptions(controller),
                    "{settings:?}\n{controller:?}"
                );
            }
            s.cover(built.is_ok(), "accepted");
            s.cover(built.is_err(), "refused");
            let law = built.as_ref().map(|wall| &wall.law);
            s.cover(matches!(law, Ok(AnyLaw::Enhanced(..))), "enhanced");
            s.cover(matches!(law, Ok(AnyLaw::Fba(..))), "fba");
            let guarded = built.as_ref().is_ok_and(|wall| wall.guard.is_some());
            s.cover(guarded, "guarded");
            let estimated =
                |wall: &Controller<Fixed32>| matches!(wall.states, States::Estimated(..));
            s.cover(built.as_ref().is_ok_and(estimated), "estimated");
            s.cover(
                matches!(built, Err(SettingsError::OutOfFormat { .. })),
                "format",
            );
            s.cover(
                matches!(built, Err(SettingsError::NoCompensation { .. })),
                "no compensation",
            );
            if let Ok(narrow) = Controller::<Fixed16>::new(&settings) {
                assert!(satisfies_assumptions(&narrow), "{settings:?}\n{narrow:?}");
            }
            if let Ok(narrow) = Controller::<Fixed8>::new(&settings) {
                assert!(satisfies_assumptions(&narrow), "{settings:?}\n{narrow:?}");
            }
        }
        for seed in ["a", "b", "c", "d", "e", "f", "g", "h"] {
            sample(seed, |s| {
                for _ in 0..40 {
                    body(s);
                }
            });
        }
    }

    /// Checks that settings are accepted on one side of every documented bound and refused on the other, one step of 2^-32 apart.
    #[test]
    fn p8_every_bound_is_where_it_is_said_to_be() {
        type Put = fn(&mut Settings, Si);
        let bounds: [(Field, &str, &str, Put); 12] = [
            (Field::KDesired, "0", "500000", |s, x| s.k_desired = x),
            (Field::KSoft, "0.01", "500000", |s, x| s.k_soft = x),
            (Field::DeviceDamping, "0", "10000", |s, x| {
                s.device_damping = x
            }),
            (Field::VirtualDamping, "0", "10000", |s, x| {
                s.virtual_damping = x
            }),
            (Field::StepOfIdeal, "0", "1", |s, x| s.step_of_ideal = x),
            (Field::LimitOfForce, "0", "1", |s, x| s.limit_of_force = x),
            (Field::LimitOfPenetration, "0", "1", |s, x| {
                s.limit_of_penetration = x
            }),
            (Field::FilterMass, "0", "10000", |s, x| s.filter.mass = x),
            (Field::FilterStiffness, "0.01", "500000", |s, x| {
                s.filter.stiffness = x
            }),
            (Field::FilterDamping, "0", "10000", |s, x| {
                s.filter.damping = x
            }),
            (Field::FilterGroundDamping, "0", "10000", |s, x| {
                s.filter.ground_damping = x
            }),
            (Field::EnergyCredit, "0", "1000", |s, x| s.energy_credit = x),
        ];
        for (field, min, max, put) in bounds {
            let refused = |value: Si| {
                let mut settings = Settings::thesis();
                put(&mut settings, value);
                match settings.validate() {
                    Err(SettingsError::OutOfRange { field: named, .. }) => {
                        assert_eq!(named, field);
                        true
                    }
                    _ => false,
                }
            };
            let (min, max): (Si, Si) = (min.parse().unwrap(), max.parse().unwrap());
            assert!(!refused(min) && !refused(max), "{}", field.path());
            assert!(
                refused(min - Si::DELTA) && refused(max + Si::DELTA),
                "{}",
                field.path()
            );
        }
        let with = |rate_hz, force_limit: &str| Settings {
            rate_hz,
            force_limit: force_limit.parse().unwrap(),
            ..Settings::thesis()
        };
        assert!(with(1, "100").validate().is_ok() && with(100_000, "0.000001").validate().is_ok());
        assert!(with(0, "1").validate().is_err() && with(100_001, "1").validate().is_err());
        assert!(
            with(1_000, "100.000001").validate().is_err() && with(1_000, "0").validate().is_err()
        );
    }
}
