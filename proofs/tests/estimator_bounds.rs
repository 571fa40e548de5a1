//! Tests both sides of the ranges of the estimator's coefficients, what restarts the estimator, and the velocity filters that use
//! the same functions.

use touchstone_control::estimator::{DeviceInTicks, EstimatedMotion, Flow};
use touchstone_control::fixed::types::{I8F24, I8F56};
use touchstone_control::number::{Exact, Wide, Wide64};
use touchstone_control::velocity::Velocity;
use touchstone_control::{
    Estimator, EstimatorSettings, Field, Fixed32, Force, Position, SettingsError, Si, VelocityKind,
    VelocitySettings,
};

type N = Fixed32;

fn si(text: &str) -> Si {
    text.parse().expect("a number")
}
fn weight(x: f64) -> i32 {
    Wide64::weight(I8F56::from_num(x)).expect("in its range")
}

/// Coefficients at the ends of their ranges, except `ahead.commands`. At the limit of 1 N·m the commands of `tick` add up to just
/// under the allowed 2 rad.
fn at_ends() -> Estimator<N> {
    let torque = |x: f64| Wide64::torque_weight(I8F56::from_num(x)).expect("in its range");
    Estimator {
        tick: Flow {
            reach: weight(1.0),
            drift: weight(1.0),
            loss: weight(1.0),
            commands: [[torque(1.0); 2], [torque(1.0) - 1, 0], [0, torque(1.0) - 1]],
        },
        ahead: Flow {
            reach: weight(2.0),
            drift: weight(2.0),
            loss: weight(1.0),
            commands: [[torque(1.5); 2], [torque(1.5); 2]],
        },
        correction: [weight(1.0), weight(2.0), weight(2.0)],
        limit: Force(I8F24::ONE),
    }
}

#[test]
fn an_estimator_is_bounded_up_to_every_end_and_no_further() {
    assert!(at_ends().is_bounded());
    let without = |change: &dyn Fn(&mut Estimator<N>)| {
        let mut changed = at_ends();
        change(&mut changed);
        changed.is_bounded()
    };
    assert!(without(&|it| it.limit = Force::zero()));
    assert!(!without(&|it| it.limit = -Force(I8F24::DELTA)));
    for (name, refused) in [
        ("reach", without(&|it| it.tick.reach += 1)),
        ("drift", without(&|it| it.tick.drift += 1)),
        ("loss", without(&|it| it.tick.loss += 1)),
        ("reach ahead", without(&|it| it.ahead.reach += 1)),
        ("drift ahead", without(&|it| it.ahead.drift += 1)),
        ("loss ahead", without(&|it| it.ahead.loss += 1)),
        ("no reach", without(&|it| it.tick.reach = -1)),
        ("position", without(&|it| it.correction[0] += 1)),
        ("moved", without(&|it| it.correction[1] += 1)),
        ("pushed", without(&|it| it.correction[2] += 1)),
        ("moved back", without(&|it| it.correction[1] = -1)),
        // Two commands together displace by 2 rad; each alone by less.
        ("place", without(&|it| it.tick.commands[1][0] += 1)),
        ("velocity", without(&|it| it.tick.commands[2][1] += 1)),
        ("a push", without(&|it| it.tick.commands[0][0] = -1)),
    ] {
        assert!(!refused, "{name}");
    }
}

fn settings(bandwidth_hz: &str, inertia: &str, damping: &str) -> EstimatorSettings {
    EstimatorSettings {
        bandwidth_hz: si(bandwidth_hz),
        inertia: si(inertia),
        damping: si(damping),
        delay_s: Si::ZERO,
    }
}

#[test]
fn what_no_device_does_starts_the_estimator_anew() {
    let estimator: Estimator<N> = settings("60", "0.0001", "0.0005")
        .estimator(1000, Si::ONE)
        .expect("accepted");
    let at = |radians: f64| Position::<N>(I8F24::from_num(radians));
    let before = EstimatedMotion::standing(at(0.0));
    let after = |radians| estimator.corrected(&before, &[0; 3], at(radians));
    for jump in [0.001, 3.0, -3.0] {
        assert!(after(jump).is_some(), "{jump}");
    }
    for jump in [8.0, 9.0, 20.0, 100.0, -8.1, -20.0, -100.0] {
        assert_eq!(after(jump), None, "{jump}");
    }
    // The same motion starts at another place: only the difference of positions counts.
    let before = EstimatedMotion::standing(at(100.0));
    let moved = estimator.corrected(&before, &[0; 3], at(100.001));
    assert!(moved.is_some_and(|it| it.moved != Wide64::default()));
}

#[test]
fn what_brakes_harder_than_an_estimator_sees_is_left_to_the_push() {
    let made = |damping| {
        settings("60", "0.000001", damping)
            .estimator::<N>(1000, si("0.5"))
            .expect("accepted")
    };
    // 2π times 60 Hz times a tick is 0.377. With an inertia of 1 N·m per tick² this is a damping of 0.000377 N·m·s/rad, the largest
    // that the estimator uses. The last two dampings would take 200 and 1000 times the velocity per tick.
    let clipped = made("0.0004");
    for damping in ["0.001", "0.1", "0.2", "1"] {
        assert_eq!(made(damping), clipped, "{damping}");
    }
    assert_ne!(made("0.0003"), clipped);
}

#[test]
fn an_estimator_is_the_same_in_the_ticks_of_any_rate() {
    let at = |rate, bandwidth, inertia, damping| {
        settings(bandwidth, inertia, damping).estimator::<N>(rate, Si::ONE)
    };
    let one = at(1, "0.1", "2", "0.5").expect("accepted");
    // With a tick of half a second: a quarter of the inertia and half of the damping.
    assert_eq!(at(2, "0.2", "0.5", "0.25"), Ok(one));
    assert_eq!(at(4, "0.4", "0.125", "0.125"), Ok(one));
}

#[test]
fn an_estimator_takes_the_lightest_inertia_and_no_lighter_one() {
    let accepts = |rate, inertia: Si, limit: &str| {
        let settings = EstimatorSettings {
            inertia,
            ..settings("0.1", "1", "0.1")
        };
        settings.validate(rate, si(limit))
    };
    for (inertia, limit) in [("1", "1"), ("2", "2"), ("0.76", "0.5")] {
        assert_eq!(accepts(1, si(inertia), limit), Ok(()));
        let refused = accepts(1, si(inertia) - Si::DELTA, limit);
        let is_inertia = matches!(
            refused,
            Err(SettingsError::OutOfRange {
                field: Field::EstimatorInertia,
                ..
            })
        );
        assert!(is_inertia, "{inertia}: {refused:?}");
    }
    // At 1 Hz and a force limit of 1 N·m the smallest accepted inertia is 1 kg·m².
    assert!(accepts(1, si("0.5"), "1").is_err());
}

#[test]
fn an_estimator_s_bandwidth_goes_up_to_both_ends() {
    let accepts = |rate, bandwidth_hz| {
        let settings = EstimatorSettings {
            bandwidth_hz,
            inertia: si("0.0001"),
            ..settings("1", "1", "0.0005")
        };
        settings.validate(rate, Si::ONE).is_ok()
    };
    let rate = 1000;
    let (low, high) = (
        Si::from_num(rate).saturating_div(Si::from_num(500)),
        Si::from_num(rate).saturating_div(Si::from_num(5)),
    );
    assert!(accepts(rate, low) && accepts(rate, high));
    assert!(!accepts(rate, low - Si::DELTA) && !accepts(rate, high + Si::DELTA));
}

#[test]
fn a_free_tick_is_that_of_a_device_without_brake_and_drive() {
    let nothing = DeviceInTicks {
        loss: Exact::ZERO,
        per_torque: Exact::ZERO,
        delay: Exact::ZERO,
    };
    let (free, made) = (Flow::<N, 0>::free().unwrap(), nothing.tick::<N>().unwrap());
    assert_eq!(
        [free.reach, free.drift, free.loss],
        [made.reach, made.drift, made.loss]
    );
}

#[test]
fn a_tracker_is_the_estimator_of_a_device_that_nothing_brakes() {
    for from in [VelocityKind::Kalman, VelocityKind::KalmanAcceleration] {
        let settings = VelocitySettings {
            from,
            ..VelocitySettings::default()
        };
        let Ok(Some(Velocity::Tracker(tracker))) = settings.velocity::<N>(1000, si("0.0001"))
        else {
            panic!("{from:?} is a tracker");
        };
        let free = tracker.free;
        // Expected: V = 1, X = 1/2, and no loss.
        assert_eq!((free.reach, free.loss), (weight(1.0), 0));
        assert_eq!(free.drift, weight(0.5));
        // α = 1 - r², β = 2 (1 - r)², and γ = β²/2α or 0.
        let angle = settings.bandwidth_hz.to_num::<f64>() * core::f64::consts::TAU / 1000.0;
        let accelerates = from == VelocityKind::KalmanAcceleration;
        let r = if accelerates {
            (-angle).exp()
        } else {
            (-angle * core::f64::consts::FRAC_1_SQRT_2).exp()
        };
        let (alpha, beta) = (1.0 - r * r, 2.0 * (1.0 - r) * (1.0 - r));
        let gamma = if accelerates {
            beta * beta / (2.0 * alpha)
        } else {
            0.0
        };
        let near = |weight: i32, value: f64| (f64::from(weight) / f64::from(1 << 26) - value).abs();
        let [position, moved, pushed] = tracker.correction;
        for (weight, value) in [(position, alpha), (moved, beta), (pushed, gamma)] {
            assert!(near(weight, value) < 1e-7, "{from:?} {weight} {value}");
        }
    }
}
