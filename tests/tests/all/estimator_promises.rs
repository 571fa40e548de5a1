//! Tests the state estimator (position and speed from a model of the device) where its assumptions fail: a wrong inertia, jumps,
//! settings out of range.

use touchstone_control::estimator::EstimatorState;
use touchstone_control::{
    EstimatorSettings, Field, Fixed8, Fixed16, Fixed32, Force, Position, Reported, SettingsError,
    Si,
};
use touchstone_tests::estimator::{DEVICES, LIMIT, amplification, estimator, reference, settings};
use touchstone_tests::random::Random;

/// Simulates a knob with this inertia in a soft grip, against a force that changes every 50 ms. Calls `tick` in every control
/// period with its number, the knob's position and displacement per period, and the force from then on.
fn knob(inertia: f64, ticks: u32, mut tick: impl FnMut(u32, f64, f64, f64)) {
    const PARTS: u32 = 200;
    let t = 1e-3 / f64::from(PARTS);
    let (mut x, mut v) = (0.0_f64, 0.0_f64);
    for n in 0..ticks {
        let force = if n / 50 % 2 == 0 { 0.05 } else { 0.1 };
        tick(n, x, v * 1e-3, force);
        for _ in 0..PARTS {
            let a = (0.075 - 0.05 * x - 0.0005 * v - force) / inertia;
            v += a * t;
            x += v * t;
        }
    }
}

#[test]
fn a_wrong_inertia_costs_what_the_force_changes_by_and_no_more() {
    let device = (1000, "60", "0.0001", "0", 0.0);
    let [right, light, heavy] = [1e-4, 0.5e-4, 2e-4].map(|inertia| {
        let (law, mut state) = (estimator::<f64>(&device), EstimatorState::default());
        let mut worst = 0.0_f64;
        knob(inertia, 3_000, |n, x, d, force| {
            let sample = law.tick(&mut state, Position(x));
            law.commanded(&mut state, Force(force));
            if n > 500 {
                worst = worst.max((sample.moved.0 - d).abs());
            }
        });
        worst
    });
    // With a wrong inertia the estimator expects a wrong response to a change of force of 0.05 N·m. The error per tick is that
    // force times the error of T²/J: half of it in the position, all of it in the displacement. The grip's forces add at most three
    // times the error with the right inertia.
    let sums = amplification(&reference(&device), 0.0)[1];
    let bound = |inertia: f64| {
        let push = 0.05 * 1e-6 * (1.0 / inertia - 1e4_f64).abs();
        push * (0.5 * sums[0] + sums[1]) + 3.0 * right
    };
    println!("displacement per tick off by {right:.1e}; {light:.1e}, {heavy:.1e} rad");
    assert!(right < 2e-4 && light > right && heavy > right);
    assert!(
        light < bound(0.5e-4) && heavy < bound(2e-4),
        "{} {}",
        bound(0.5e-4),
        bound(2e-4)
    );
}

#[test]
fn nothing_overflows_whatever_is_measured_and_jumps_are_forgotten() {
    fn hammer<N: Reported>(seed: u64) {
        let mut random = Random::new(seed);
        for device in &DEVICES {
            let Ok(law) = settings(device).estimator::<N>(device.0, LIMIT) else {
                continue;
            };
            let mut state = EstimatorState::default();
            for n in 0..20_000 {
                // Any positions, slow motions, the ends of the range, and to and fro: debug builds panic if a sum does not fit.
                let e = match n / 500 % 5 {
                    0 => 128.0 * random.real(),
                    1 => 2.0 * random.real(),
                    2 => [127.9, -128.0][n % 2],
                    3 => [7.9, 0.0][n / 2 % 2],
                    _ => 127.0 + 0.9 * random.real(),
                };
                law.tick(&mut state, Position::from_f64(e));
                law.commanded(&mut state, Force::from_f64(128.0 * random.real()));
            }
            let still = Position::from_f64(0.25);
            for n in 0..4_000 {
                let sample = law.tick(&mut state, still);
                law.commanded(&mut state, Force::zero());
                if n > 3_000 {
                    let off = (sample.e - still).modulus().max(sample.moved.modulus());
                    assert!(off.to_f64() <= 2f64.powi(-23), "{device:?}: {sample:?}");
                }
            }
        }
    }
    hammer::<Fixed32>(3);
    hammer::<Fixed16>(4);
    hammer::<Fixed8>(5);
    hammer::<f64>(6);
}

#[test]
fn the_first_tick_shows_what_is_measured() {
    let (law, mut state) = (estimator::<Fixed32>(&DEVICES[0]), EstimatorState::default());
    let e = Position::from_f64(-3.25);
    let sample = law.tick(&mut state, e);
    assert_eq!((sample.e, sample.moved), (e, Position::zero()));
}

#[test]
fn settings_out_of_range_are_refused_by_name_and_their_limits_accepted() {
    let good = EstimatorSettings::default();
    let lit = |text: &str| Si::from_str(text).unwrap();
    assert_eq!(good.validate(1000, LIMIT), Ok(()));
    /// A test case: setting, function that sets it, both ends of the accepted range, and refused values beyond both.
    type Case = (
        Field,
        fn(&mut EstimatorSettings, Si),
        [&'static str; 2],
        [&'static str; 2],
    );
    let cases: [Case; 4] = [
        (
            Field::EstimatorBandwidth,
            |s, x| s.bandwidth_hz = x,
            ["2", "200"],
            ["1.9", "201"],
        ),
        (
            Field::EstimatorInertia,
            |s, x| s.inertia = x,
            ["0.0000008", "60"],
            ["0.0000007", "60.1"],
        ),
        (
            Field::EstimatorDamping,
            |s, x| s.damping = x,
            ["0", "10000"],
            ["-0.1", "10001"],
        ),
        (
            Field::EstimatorDelay,
            |s, x| s.delay_s = x,
            ["0", "2"],
            ["-0.001", "2.1"],
        ),
    ];
    for (field, set, inside, outside) in cases {
        for text in inside {
            let mut settings = good;
            set(&mut settings, lit(text));
            assert_eq!(
                settings.validate(1000, LIMIT),
                Ok(()),
                "{} {text}",
                field.path()
            );
            assert!(
                settings.estimator::<Fixed32>(1000, LIMIT).is_ok(),
                "{} {text}",
                field.path()
            );
        }
        for text in outside {
            let mut settings = good;
            set(&mut settings, lit(text));
            let error = settings.validate(1000, LIMIT).unwrap_err();
            let SettingsError::OutOfRange {
                field: named,
                value,
                min,
                max,
            } = error
            else {
                panic!("{error}")
            };
            assert_eq!(named, field, "{text}");
            assert!(value < min || value > max, "{error}");
            assert!(error.to_string().contains(field.path()), "{error}");
        }
    }
}
