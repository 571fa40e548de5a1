//! Tests that the guard's coefficients equal the specification's on both sides of every step: where a coefficient changes by its
//! last digit, or where settings begin to be refused. The tests find the steps by bisection.

use touchstone_control::fixed::types::I2F14;
use touchstone_control::{
    ChangeOfForce, Compliance, Fixed16, Fixed32, Guard, GuardSettings, GuardedDevice,
    SettingsError, Si, Warning,
};
use touchstone_proofs::set::specified_settings;
use touchstone_proofs::spec::guard_settings::{in_ranges, made};
use touchstone_proofs::spec::{Int, guard as spec};
use touchstone_proofs::specified::at32::guard as specified;

fn si(text: &str) -> Si {
    text.parse().expect("a number")
}

fn usual() -> (GuardSettings, GuardedDevice) {
    (
        GuardSettings {
            on: true,
            capacity: si("0.02"),
            refill: si("0.001"),
            share_of_damping: si("0.8"),
            damping: si("0.5"),
            overspeed: si("50"),
            delay: si("0.0005"),
            lag: si("0.0002"),
            change: ChangeOfForce::Estimated,
        },
        GuardedDevice {
            rate_hz: 1000,
            force_limit: si("0.5"),
            count: si("0.0001"),
        },
    )
}

fn expected(settings: &GuardSettings, device: &GuardedDevice) -> Option<spec::Guard> {
    let (settings, device) = specified_settings(settings, device);
    in_ranges(&settings, &device)
        .then(|| made(&settings, &device))
        .flatten()
}

/// Asserts that the code equals the specification for settings from 2 steps of 2^-32 below `at` to 3 above.
fn is_the_specification_around(
    at: i64,
    with: &dyn Fn(Si) -> (GuardSettings, GuardedDevice),
    what: &str,
) {
    for near in at - 2..at + 4 {
        let (settings, device) = with(Si::from_bits(near));
        let got = Guard::<Fixed32>::new(&settings, &device).ok();
        assert_eq!(
            got.as_ref().map(specified),
            expected(&settings, &device),
            "{what} at {}",
            Si::from_bits(near)
        );
    }
}

/// The largest setting at which a function still has the value of the lower end, found by bisection. `None` if both ends have the
/// same value.
fn step_of<T: PartialEq>([mut low, mut high]: [i64; 2], of: &dyn Fn(Si) -> T) -> Option<i64> {
    if of(Si::from_bits(low)) == of(Si::from_bits(high)) {
        return None;
    }
    while high - low > 1 {
        let middle = low + (high - low) / 2;
        if of(Si::from_bits(middle)) == of(Si::from_bits(low)) {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(low)
}

#[test]
fn where_a_coefficient_steps_it_is_the_specification_s() {
    type With = fn(Si) -> (GuardSettings, GuardedDevice);
    // The displacement per tick is large, so that a step of the capacity changes the largest change of force by only a few steps of
    // its format.
    fn slow() -> (GuardSettings, GuardedDevice) {
        let (settings, device) = usual();
        (
            GuardSettings {
                overspeed: si("10"),
                damping: si("100"),
                delay: Si::ZERO,
                lag: Si::ZERO,
                ..settings
            },
            GuardedDevice {
                rate_hz: 5,
                ..device
            },
        )
    }
    let settings: [(&str, With, [&str; 2]); 9] = [
        (
            "capacity, of a slow tick",
            |capacity| {
                let (settings, device) = slow();
                (
                    GuardSettings {
                        capacity,
                        ..settings
                    },
                    device,
                )
            },
            ["0.5", "6"],
        ),
        (
            "capacity",
            |capacity| {
                let (settings, device) = usual();
                (
                    GuardSettings {
                        capacity,
                        ..settings
                    },
                    device,
                )
            },
            ["0.0001", "2"],
        ),
        (
            "damping",
            |damping| {
                let (settings, device) = usual();
                (
                    GuardSettings {
                        damping,
                        ..settings
                    },
                    device,
                )
            },
            ["0.1", "2"],
        ),
        (
            "overspeed",
            |overspeed| {
                let (settings, device) = usual();
                (
                    GuardSettings {
                        overspeed,
                        ..settings
                    },
                    device,
                )
            },
            ["3", "500"],
        ),
        (
            "delay",
            |delay| {
                let (settings, device) = usual();
                (GuardSettings { delay, ..settings }, device)
            },
            ["0", "0.0008"],
        ),
        (
            "lag",
            |lag| {
                let (settings, device) = usual();
                (GuardSettings { lag, ..settings }, device)
            },
            ["0", "0.0005"],
        ),
        (
            "lag, measured",
            |lag| {
                let (settings, device) = usual();
                let change = ChangeOfForce::Measured;
                (
                    GuardSettings {
                        lag,
                        change,
                        ..settings
                    },
                    device,
                )
            },
            ["0", "0.0005"],
        ),
        (
            "count",
            |count| {
                let (settings, device) = usual();
                (settings, GuardedDevice { count, ..device })
            },
            ["0", "0.1"],
        ),
        (
            "refill",
            |refill| {
                let (settings, device) = usual();
                (GuardSettings { refill, ..settings }, device)
            },
            ["0", "1"],
        ),
    ];
    type Coefficient = fn(&spec::Guard) -> Int;
    let coefficients: [(&str, Coefficient); 8] = [
        ("slack", |it| it.slack),
        ("capacity", |it| it.capacity >> 16),
        ("damping", |it| it.damping),
        ("stray", |it| it.stray),
        ("late", |it| it.late),
        ("per reach", |it| it.per_reach),
        ("in flight", |it| it.in_flight),
        ("overrun", |it| it.overrun),
    ];
    let mut steps = 0;
    for (name, with, ends) in settings {
        let ends = ends.map(|end| si(end).to_bits());
        for (coefficient, of) in coefficients {
            let of = |x: Si| {
                let (settings, device) = with(x);
                expected(&settings, &device).map(|it| of(&it))
            };
            // In the whole range, and in quarters of it.
            for part in 0..4 {
                let size = (ends[1] - ends[0]) >> (3 * part);
                if let Some(at) = step_of([ends[0], ends[0] + size], &of) {
                    steps += 1;
                    is_the_specification_around(at, &with, &format!("{coefficient} by {name}"));
                }
            }
        }
    }
    println!("{steps} steps");
    assert!(steps > 100);
}

#[test]
fn the_way_under_a_force_in_flight_is_refused_where_its_books_would_not_fit() {
    // A force that begins to act a whole tick late, and a displacement of nearly 32 rad in that tick.
    let with = |overspeed: Si| {
        let (settings, device) = usual();
        (
            GuardSettings {
                overspeed,
                damping: si("1000"),
                share_of_damping: Si::ONE,
                capacity: si("0.001"),
                delay: Si::ONE / Si::from_num(20),
                lag: Si::ZERO,
                ..settings
            },
            GuardedDevice {
                rate_hz: 20,
                count: Si::ZERO,
                ..device
            },
        )
    };
    let damped = |overspeed: Si| {
        let (settings, device) = with(overspeed);
        // The largest damping for which the energy account has room.
        let damping = si("0.01");
        (
            GuardSettings {
                damping,
                ..settings
            },
            device,
        )
    };
    let refused = |overspeed: Si| {
        let (settings, device) = damped(overspeed);
        expected(&settings, &device).is_none()
    };
    let at = step_of([si("100").to_bits(), si("1000").to_bits()], &refused);
    let at = at.expect("a way of 50 rad in a tick does not fit, one of 5 does");
    is_the_specification_around(at, &damped, "refused");
}

#[test]
fn a_count_is_accepted_up_to_a_tenth() {
    let (settings, device) = usual();
    let with = |count| {
        let device = GuardedDevice { count, ..device };
        settings.validate(&device)
    };
    assert_eq!(with(si("0.1")), Ok(()));
    assert!(matches!(
        with(si("0.1") + Si::DELTA),
        Err(SettingsError::TooCoarse { .. })
    ));
    assert!(with(-Si::DELTA).is_err());
}

#[test]
fn without_damping_overspeed_costs_what_the_format_holds() {
    let (settings, device) = usual();
    let undamped = GuardSettings {
        damping: si("0.00001"),
        delay: Si::ZERO,
        lag: Si::ZERO,
        ..settings
    };
    let in_16 = Guard::<Fixed16>::new(&undamped, &device).expect("accepted");
    assert_eq!(in_16.overrun, Compliance(I2F14::ONE));
    let in_32 = |damping| {
        let settings = GuardSettings {
            damping,
            ..undamped
        };
        let guard = Guard::<Fixed32>::new(&settings, &device).expect("accepted");
        guard.overrun.0.to_num::<f64>()
    };
    // 1/4c, or the largest number if that does not fit.
    assert!((in_32(si("0.0001")) - 3.125).abs() < 1e-4);
    assert_eq!(in_32(si("0.000001")), 127.0);
    assert_eq!(in_32(Si::ZERO), 127.0);
}

#[test]
fn an_account_that_just_suffices_is_no_warning() {
    let (settings, device) = usual();
    let device = GuardedDevice {
        count: si("0.05"),
        ..device
    };
    let of = |capacity| {
        GuardSettings {
            capacity,
            ..settings
        }
        .warnings(&device)[0]
    };
    let Some(Warning::GuardSoftensAtForceLimit { needed, .. }) = of(Si::ZERO) else {
        panic!("nothing answers for no force");
    };
    // f D (1 + s) + f δ/2.
    let expected = 0.5 * (0.05 + 2.0 * 0.05) * 1.7 + 0.5 * 0.05 / 2.0;
    assert!((needed.to_num::<f64>() - expected).abs() < 1e-6, "{needed}");
    assert!(of(needed).is_none() && of(needed - Si::DELTA).is_some());
}
