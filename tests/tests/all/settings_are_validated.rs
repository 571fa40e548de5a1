//! Tests both sides of every bound of [`Settings`]: the last accepted value, and the error for the next one. The bounds are
//! repeated in this file on purpose, so that a changed bound makes a test fail.

use touchstone_control::{
    Controller, Field, Fixed16, Fixed32, LawKind, Number, Regulate, Settings, SettingsError, Si,
};
use touchstone_tests::si::{assert_one_line, next, si};

/// A setting, the function that sets it, and its smallest and largest accepted value.
type Bound = (Field, fn(&mut Settings, Si), &'static str, &'static str);

const BOUNDS: [Bound; 31] = [
    (Field::KDesired, |s, x| s.k_desired = x, "0", "500000"),
    (Field::KSoft, |s, x| s.k_soft = x, "0.01", "500000"),
    (
        Field::DeviceDamping,
        |s, x| s.device_damping = x,
        "0",
        "10000",
    ),
    (
        Field::VirtualDamping,
        |s, x| s.virtual_damping = x,
        "0",
        "10000",
    ),
    (Field::StepOfIdeal, |s, x| s.step_of_ideal = x, "0", "1"),
    (Field::LimitOfForce, |s, x| s.limit_of_force = x, "0", "1"),
    (
        Field::LimitOfPenetration,
        |s, x| s.limit_of_penetration = x,
        "0",
        "1",
    ),
    (Field::FilterMass, |s, x| s.filter.mass = x, "0", "10000"),
    (
        Field::FilterStiffness,
        |s, x| s.filter.stiffness = x,
        "0.01",
        "500000",
    ),
    (
        Field::FilterDamping,
        |s, x| s.filter.damping = x,
        "0",
        "10000",
    ),
    (
        Field::FilterGroundDamping,
        |s, x| s.filter.ground_damping = x,
        "0",
        "10000",
    ),
    (Field::EnergyCredit, |s, x| s.energy_credit = x, "0", "1000"),
    (
        Field::ForceLimit,
        |s, x| s.force_limit = x,
        "0.000001",
        "100",
    ),
    (
        Field::PositionError,
        |s, x| s.position_error = x,
        "0",
        "0.05",
    ),
    // Measured states and no guard. Settings that only an estimator or a guard uses have their own tests.
    (
        Field::EstimatorBandwidth,
        |s, x| s.estimator.bandwidth_hz = x,
        "0.002",
        "20000",
    ),
    (
        Field::EstimatorInertia,
        |s, x| s.estimator.inertia = x,
        "0",
        "10000",
    ),
    (
        Field::EstimatorDamping,
        |s, x| s.estimator.damping = x,
        "0",
        "10000",
    ),
    (
        Field::EstimatorDelay,
        |s, x| s.estimator.delay_s = x,
        "0",
        "2",
    ),
    (Field::GuardCapacity, |s, x| s.guard.capacity = x, "0", "16"),
    (Field::GuardRefill, |s, x| s.guard.refill = x, "0", "1"),
    (Field::GuardDamping, |s, x| s.guard.damping = x, "0", "1000"),
    (
        Field::GuardShare,
        |s, x| s.guard.share_of_damping = x,
        "0",
        "1",
    ),
    (
        Field::GuardOverspeed,
        |s, x| s.guard.overspeed = x,
        "0.001",
        "1000",
    ),
    (Field::GuardDelay, |s, x| s.guard.delay = x, "0", "1"),
    (Field::GuardLag, |s, x| s.guard.lag = x, "0", "1"),
    // `velocity.rs` tests the range of the bandwidth where it is used.
    (
        Field::VelocityBandwidth,
        |s, x| s.velocity.bandwidth_hz = x,
        "0.002",
        "20000",
    ),
    (
        Field::VelocityWindow,
        |s, x| s.velocity.window_s = x,
        "0",
        "1",
    ),
    (
        Field::ImpactMomentum,
        |s, x| s.impact.momentum = x,
        "0",
        "2",
    ),
    (
        Field::ImpactVibration,
        |s, x| s.impact.vibration = x,
        "0",
        "1",
    ),
    (
        Field::ImpactFrequency,
        |s, x| s.impact.frequency_hz = x,
        "1",
        "1000",
    ),
    (
        Field::ImpactDecay,
        |s, x| s.impact.decay_s = x,
        "0.001",
        "1",
    ),
];

fn with(set: fn(&mut Settings, Si), value: Si) -> Settings {
    let mut settings = Settings::thesis();
    set(&mut settings, value);
    settings
}

#[test]
fn every_field_is_checked_on_both_sides_of_both_ends() {
    for (field, set, min, max) in BOUNDS {
        let (min, max) = (si(min), si(max));
        for good in [min, max] {
            assert_eq!(with(set, good).validate(), Ok(()), "{field:?} = {good}");
        }
        for value in [next(min, false), next(max, true), Si::MIN, Si::MAX] {
            let error = SettingsError::OutOfRange {
                field,
                value,
                min,
                max,
            };
            assert_eq!(
                with(set, value).validate(),
                Err(error),
                "{field:?} = {value}"
            );
            // The controller refuses whatever `validate` refuses, in every format.
            assert_eq!(Controller::<Fixed32>::new(&with(set, value)), Err(error));
            assert_eq!(Controller::<f64>::new(&with(set, value)), Err(error));
            let text = error.to_string();
            assert_one_line(&text);
            assert!(text.starts_with(&format!("{} = ", field.path())), "{text}");
            let range = format!("{value} is outside {min} to {max}");
            assert!(text.ends_with(&range), "{text}");
        }
    }
}

#[test]
fn the_rate_is_checked_on_both_sides_of_both_ends() {
    let at = |rate_hz| Settings {
        rate_hz,
        ..Settings::thesis()
    };
    assert_eq!(at(1).validate(), Ok(()));
    assert_eq!(at(100_000).validate(), Ok(()));
    for rate_hz in [0, 100_001, u32::MAX] {
        let error = at(rate_hz).validate().unwrap_err();
        let SettingsError::OutOfRange {
            field, min, max, ..
        } = error
        else {
            panic!("{error:?}");
        };
        assert_eq!((field, min, max), (Field::RateHz, Si::ONE, si("100000")));
        assert_one_line(&error.to_string());
    }
}

#[test]
fn no_field_is_without_a_bound_and_every_name_is_its_own() {
    let mut checked: Vec<_> = BOUNDS.iter().map(|bound| bound.0).collect();
    checked.push(Field::RateHz);
    // Words and flags: their type is their range.
    checked.extend([
        Field::Law,
        Field::Observer,
        Field::CountDeviceDamping,
        Field::FirstContact,
        Field::Regulate,
        Field::OffsetUpdate,
        Field::IdealStep,
        Field::States,
        Field::Guard,
        Field::GuardChange,
        Field::VelocityFrom,
    ]);
    let mut names = Vec::new();
    for field in Field::ALL {
        assert!(checked.contains(field), "{field:?} is in no test");
        assert!(!names.contains(&field.path()), "{}", field.path());
        names.push(field.path());
    }
    assert_eq!(checked.len(), Field::ALL.len());
}

#[test]
fn the_compensated_regulator_needs_a_coupling_above_the_desired_stiffness() {
    let mut settings = Settings {
        regulate: Regulate::MassCompensated,
        ..Settings::thesis()
    };
    let k_desired = settings.k_desired;
    settings.filter.stiffness = next(k_desired, true);
    assert_eq!(settings.validate(), Ok(()));
    for k_filter in [k_desired, next(k_desired, false)] {
        settings.filter.stiffness = k_filter;
        let error = SettingsError::NoCompensation {
            k_desired,
            k_filter,
        };
        assert_eq!(settings.validate(), Err(error));
        assert_one_line(&error.to_string());
    }
    // The coupling is not checked for a regulator that does not compensate, for a desired stiffness at which the law is a plain
    // spring, or for another law.
    let others = [
        Settings {
            regulate: Regulate::Hip,
            ..settings
        },
        Settings {
            k_desired: settings.k_soft,
            ..settings
        },
        Settings {
            law: LawKind::Tdpa,
            ..settings
        },
    ];
    for other in others {
        assert_eq!(other.validate(), Ok(()), "{other:?}");
    }
}

/// Asserts that a control law accepts the setting value `last`, whose coefficient just fits the number format, and refuses
/// `first_too_large`, whose coefficient is one step larger.
fn assert_fits_up_to<N: Number>(
    law: LawKind,
    field: Field,
    set: fn(&mut Settings, Si),
    last: Si,
    first_too_large: Si,
) {
    let at = |value| Settings {
        law,
        ..with(set, value)
    };
    let good = Controller::<N>::new(&at(last));
    assert!(good.is_ok(), "{}: {field:?} = {last}: {good:?}", N::NAME);
    let error = Controller::<N>::new(&at(first_too_large)).unwrap_err();
    let SettingsError::OutOfFormat {
        field: named,
        format,
        ..
    } = error
    else {
        panic!("{}: {field:?}: {error:?}", N::NAME);
    };
    assert_eq!((named, format), (field, N::NAME));
    let text = error.to_string();
    assert_one_line(&text);
    assert!(
        text.starts_with(field.path()) && text.ends_with(N::NAME),
        "{text}"
    );
}

#[test]
fn a_coefficient_beyond_its_format_is_named_on_both_sides_of_the_end() {
    let below = |text| next(si(text), false);
    // In 16 bits stiffnesses are below 2^15/2^6 = 512, signals and ratios below 2^15/2^14 = 2, energies below 2^31/2^28 = 8.
    assert_fits_up_to::<Fixed16>(
        LawKind::Spring,
        Field::KDesired,
        |s, x| s.k_desired = x,
        below("512"),
        si("512"),
    );
    assert_fits_up_to::<Fixed16>(
        LawKind::Spring,
        Field::ForceLimit,
        |s, x| s.force_limit = x,
        below("2"),
        si("2"),
    );
    assert_fits_up_to::<Fixed16>(
        LawKind::EnhancedSfa,
        Field::EnergyCredit,
        |s, x| s.energy_credit = x,
        // The law limits its stored energy to half of the format's range, 4 J; a larger credit would be cut off.
        si("4"),
        si("4.1"),
    );
    // Damping over control period, c/T, is below 512 N·m/rad: at 1 kHz `c` is below 0.512 N·m·s/rad.
    let damper = |s: &mut Settings, x| s.virtual_damping = x;
    assert_fits_up_to::<Fixed16>(
        LawKind::SpringDamper,
        Field::VirtualDamping,
        damper,
        si("0.511"),
        si("0.513"),
    );
    let device = |s: &mut Settings, x| s.device_damping = x;
    assert_fits_up_to::<Fixed16>(
        LawKind::Fba,
        Field::DeviceDamping,
        device,
        si("0.511"),
        si("0.513"),
    );
    // In 16 bits 1/k_v is below 2 rad/(N·m), so `k_v` is above 0.5 N·m/rad.
    let soft = |s: &mut Settings, x| s.k_soft = x;
    assert_fits_up_to::<Fixed16>(LawKind::Sfa, Field::KSoft, soft, si("0.51"), si("0.5"));
    // The filter's coefficients are summed, and twice the sum must fit: m/T² + k_f + c_f/T + c_env/T is below 2^18 N·m/rad in 32
    // bits. One step of the setting `m` (2^-32) changes m/T² by 0.00023 N·m/rad; the margin of 0.0005 is two steps.
    let mass = |s: &mut Settings, x: Si| s.filter.mass = x;
    let others = si("11"); // k_f = 1, c_env/T = 10
    let last = si("262144") - others;
    let per_kg = Si::from_num(1_000_000);
    let (last, first) = (
        (last - si("0.0005")) / per_kg,
        (last + si("0.0005")) / per_kg,
    );
    assert_fits_up_to::<Fixed32>(
        LawKind::EnhancedSfa,
        Field::FilterMass,
        mass,
        last,
        next(first, true),
    );
}

#[test]
fn whatever_the_settings_accept_the_reference_can_be_built() {
    for (field, set, min, max) in BOUNDS {
        for value in [si(min), si(max)] {
            for law in [
                LawKind::Spring,
                LawKind::SpringDamper,
                LawKind::Tdpa,
                LawKind::Fba,
                LawKind::Sfa,
                LawKind::EnhancedSfa,
            ] {
                let settings = Settings {
                    law,
                    ..with(set, value)
                };
                assert!(
                    Controller::<f64>::new(&settings).is_ok(),
                    "{law:?}, {field:?} = {value}"
                );
            }
        }
    }
}
