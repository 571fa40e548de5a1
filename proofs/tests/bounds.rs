//! Tests both sides of bounds that several settings share, and which setting a refusal names. The comparison with the specification
//! does not cover these: it only compares whether settings are accepted.

use touchstone_control::space::{FrictionError, FrictionSettings, LengthUnit};
use touchstone_control::{
    Controller, EstimatorSettings, Field, Fixed16, Fixed32, GuardSettings, GuardedDevice, Settings,
    SettingsError, Si, Warning,
};

fn si(text: &str) -> Si {
    text.parse().expect("a number")
}

/// Settings of an enhanced law whose virtual mass has the given inertia, stiffness, damping and ground damping per tick, each in
/// N·m/rad at 1 kHz.
fn of_parts([mass, stiffness, damping, ground]: [&str; 4]) -> Settings {
    let per_tick = |text| si(text) / Si::from_num(1000);
    let mut settings = Settings::thesis();
    settings.rate_hz = 1000;
    settings.filter.mass = per_tick(mass) / Si::from_num(1000);
    settings.filter.stiffness = si(stiffness);
    settings.filter.damping = per_tick(damping);
    settings.filter.ground_damping = per_tick(ground);
    settings
}

#[test]
fn the_largest_part_of_the_mass_is_blamed() {
    // Gains of the 32-bit format are below 2^19, and twice the sum must fit.
    let blamed = |parts| match Controller::<Fixed32>::new(&of_parts(parts)) {
        Err(SettingsError::OutOfFormat { field, .. }) => field,
        other => panic!("{parts:?}: {other:?}"),
    };
    for (parts, field) in [
        (["150000", "70000", "60000", "50000"], Field::FilterMass),
        (
            ["70000", "150000", "60000", "50000"],
            Field::FilterStiffness,
        ),
        (["70000", "60000", "150000", "50000"], Field::FilterDamping),
        (
            ["70000", "60000", "50000", "150000"],
            Field::FilterGroundDamping,
        ),
        // If two parts are equal, the first one is named.
        (
            ["10000", "250000", "250000", "10000"],
            Field::FilterStiffness,
        ),
    ] {
        assert_eq!(blamed(parts), field, "{parts:?}");
    }
    // A little less than half of the format's range.
    let fits = of_parts(["1000", "255000", "3000", "3000"]);
    assert!(Controller::<Fixed32>::new(&fits).is_ok());
}

#[test]
fn a_loan_of_all_that_is_stored_is_accepted() {
    let lent = |joules| {
        let mut settings = Settings::thesis();
        settings.energy_credit = si(joules);
        Controller::<Fixed16>::new(&settings)
    };
    assert!(lent("4").is_ok());
    assert!(matches!(
        lent("4.0001"),
        Err(SettingsError::OutOfFormat {
            field: Field::EnergyCredit,
            ..
        })
    ));
}

fn estimator(bandwidth_hz: Si, inertia: Si) -> EstimatorSettings {
    EstimatorSettings {
        bandwidth_hz,
        inertia,
        ..EstimatorSettings::default()
    }
}

#[test]
fn the_estimator_s_bounds_are_where_they_are_said_to_be() {
    // Columns: rate in Hz; lowest and highest bandwidth; smallest and largest inertia, for a force limit of 1 N·m.
    for (rate, bandwidths, inertias) in [
        (1000, ["2", "200"], [None, Some("60")]),
        (1, ["0.002", "0.2"], [Some("1"), None]),
    ] {
        let [low, high] = bandwidths.map(si);
        let usual = si(if rate == 1 { "2" } else { "0.0001" });
        let accepts = |bandwidth, inertia| {
            estimator(bandwidth, inertia)
                .validate(rate, Si::ONE)
                .is_ok()
        };
        assert!(accepts(low + Si::DELTA, usual) && accepts(high - Si::DELTA, usual));
        assert!(!accepts(low - Si::from_bits(2), usual) && !accepts(high + Si::DELTA, usual));
        if let [Some(lightest), _] = inertias {
            assert!(accepts(high / 2, si(lightest)));
            assert!(!accepts(high / 2, si(lightest) - Si::DELTA));
        }
        if let [_, Some(heaviest)] = inertias {
            assert!(accepts(high / 2, si(heaviest)));
            assert!(!accepts(high / 2, si(heaviest) + Si::DELTA));
        }
    }
    // The highest accepted bandwidth.
    let high = Si::from_num(1000) / 5;
    assert!(
        estimator(high, si("0.0001"))
            .validate(1000, Si::ONE)
            .is_ok()
    );
    // For an inertia below the accepted range the error names the smallest accepted one: that of the force limit, at least 0.76.
    for limit in ["1", "0.5", "3"] {
        let at = |inertia| estimator(si("60"), inertia).validate(1000, si(limit));
        let Err(SettingsError::OutOfRange { field, min, .. }) = at(si("0.0000001")) else {
            panic!("{limit}: accepted");
        };
        assert_eq!(field, Field::EstimatorInertia);
        assert!(at(min).is_ok(), "{limit}: {min}");
        assert!(at(min - Si::from_bits(2)).is_err(), "{limit}: {min}");
        let per_tick2 = min * Si::from_num(1_000_000);
        let least = si(limit).max(si("0.76"));
        assert!(per_tick2 >= least && per_tick2 < least + si("0.001"));
    }
}

#[test]
fn no_rate_is_one_a_second() {
    let settings = EstimatorSettings {
        bandwidth_hz: si("0.1"),
        inertia: si("2"),
        damping: si("0.1"),
        delay_s: si("1.5"),
    };
    let at = |rate| settings.estimator::<Fixed32>(rate, Si::ONE);
    let one = at(1).expect("accepted");
    assert_eq!(at(0), Ok(one));
    assert_eq!(settings.validate(0, Si::ONE), settings.validate(1, Si::ONE));
}

#[test]
fn a_coefficient_of_friction_is_at_most_ten() {
    let at = |static_coefficient| {
        let settings = FrictionSettings {
            stiffness: si("100"),
            static_coefficient,
            kinetic_coefficient: si("0.1"),
        };
        settings
            .friction::<Fixed32>(LengthUnit::Metre, 1000, si("10"))
            .is_ok()
    };
    assert!(at(si("10")) && !at(si("10") + Si::DELTA));
    let refused = |stiffness, unit| {
        let settings = FrictionSettings {
            stiffness,
            static_coefficient: si("0.5"),
            kinetic_coefficient: si("0.4"),
        };
        settings.friction::<Fixed32>(unit, 1000, si("10")).err()
    };
    assert!(matches!(
        refused(Si::ZERO, LengthUnit::Metre),
        Some(FrictionError::Stiffness { .. })
    ));
    // The stiffness per millimetre is rounded to 0, so friction would stretch beyond every format.
    let Some(FrictionError::OutOfFormat { value, .. }) = refused(Si::DELTA, LengthUnit::Millimetre)
    else {
        panic!("it has no reach");
    };
    assert_eq!(value, Si::MAX);
}

#[test]
fn the_guard_s_bounds_are_where_they_are_said_to_be() {
    let settings = GuardSettings {
        delay: Si::ZERO,
        lag: Si::ZERO,
        ..GuardSettings::default()
    };
    let device = GuardedDevice {
        rate_hz: 1000,
        force_limit: si("0.5"),
        count: si("0.0001"),
    };
    let at = |rate_hz, force_limit| {
        let device = GuardedDevice {
            rate_hz,
            force_limit: si(force_limit),
            ..device
        };
        settings.validate(&device).is_ok()
    };
    assert!(at(1, "0.5") && at(100_000, "0.5") && at(1000, "1000"));
    assert!(!at(0, "0.5") && !at(100_001, "0.5") && !at(1000, "1000.0000001"));
}

#[test]
fn a_guard_that_softens_says_what_its_limit_needs() {
    let device = GuardedDevice {
        rate_hz: 1000,
        force_limit: si("0.5"),
        count: si("0.01"),
    };
    let with = |capacity| GuardSettings {
        capacity,
        overspeed: si("60"),
        delay: si("0.0002"),
        lag: si("0.0001"),
        ..GuardSettings::default()
    };
    let [Some(Warning::GuardSoftensAtForceLimit { needed, .. }), _] =
        with(Si::ZERO).warnings(&device)
    else {
        panic!("an empty account answers for no force");
    };
    // f D (1 + 0.3) + f δ/2, where D is the displacement of a tick at 60 rad/s plus a count at each end.
    let expected = si("0.5") * si("0.08") * si("1.3") + si("0.0025");
    assert!((needed - expected).abs() < si("0.000001"), "{needed}");
    assert!(with(needed).warnings(&device)[0].is_none());
    assert!(with(needed - Si::DELTA).warnings(&device)[0].is_some());
}
