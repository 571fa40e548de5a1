//! Tests of presses and taps: they are smooth, and reach the torque and speed that the scene gives.

use crate::scene::{Grip, Hand, MotionSpec, RestPath, Scene};

fn scene(name: &str, sets: &[&str]) -> Scene {
    Scene::load(name)
        .and_then(|scene| scene.with_overrides(sets))
        .unwrap_or_else(|error| panic!("{error}"))
}

fn motion(scene: &Scene) -> RestPath {
    RestPath::from_scene(scene).unwrap_or_else(|error| panic!("{error}"))
}

/// Simulates device and hand by Runge-Kutta, with or without an ideal spring wall, and returns time, angle and speed every 0.1 ms.
/// The code does not use the program's plant model, so that the tests can check that model.
fn simulate(scene: &Scene, wall: bool) -> Vec<(f64, f64, f64)> {
    let motion = motion(scene);
    let hand: Hand = scene.operator.hand().expect("a hand");
    let (device, surface) = (&scene.device, scene.wall.surface_rad);
    let derivative = |t: f64, [x, v, h, u]: [f64; 4]| {
        let pad =
            hand.pad_stiffness_n_m_per_rad * (h - x) + hand.pad_damping_n_m_s_per_rad * (u - v);
        let push_out = if wall {
            scene.wall.k_desired_n_m_per_rad * (x - surface).max(0.0)
        } else {
            0.0
        };
        let pull =
            hand.stiffness_n_m_per_rad * (motion.rest_rad(t) - h) - hand.damping_n_m_s_per_rad * u;
        let a_device = (pad - device.damping_n_m_s_per_rad * v - push_out) / device.inertia_kg_m2;
        [v, a_device, u, (pull - pad) / hand.inertia_kg_m2]
    };
    let dt = 1e-4;
    let along = |s: [f64; 4], k: [f64; 4], by: f64| std::array::from_fn(|i| s[i] + k[i] * by);
    let start = scene.start_rad(&motion);
    let mut state = [start, 0.0, start, 0.0];
    let mut path = Vec::new();
    for tick in 0..(scene.timing.duration_s / dt).round() as usize {
        let t = tick as f64 * dt;
        path.push((t, state[0], state[1]));
        let k1 = derivative(t, state);
        let k2 = derivative(t + dt / 2.0, along(state, k1, dt / 2.0));
        let k3 = derivative(t + dt / 2.0, along(state, k2, dt / 2.0));
        let k4 = derivative(t + dt, along(state, k3, dt));
        state = std::array::from_fn(|i| {
            state[i] + dt / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i])
        });
    }
    path
}

/// Largest change of the rest point, and of its slope, between samples 0.1 ms apart.
fn largest_steps(scene: &Scene) -> (f64, f64) {
    let motion = motion(scene);
    let dt = 1e-4;
    let at = |i: i64| motion.rest_rad(i as f64 * dt);
    let ticks = (scene.timing.duration_s / dt) as i64 + 1000;
    let step = (0..ticks)
        .map(|i| (at(i + 1) - at(i)).abs())
        .fold(0.0, f64::max);
    let turn = (1..ticks)
        .map(|i| ((at(i + 1) - 2.0 * at(i) + at(i - 1)) / dt).abs())
        .fold(0.0, f64::max);
    (step, turn)
}

#[test]
fn presses_have_no_steps_in_angle_or_speed() {
    for name in ["thesis-knob", "press-wiggle-release"] {
        for grip in ["grip=light", "grip=medium", "grip=firm"] {
            let scene = scene(name, &[grip]);
            let hand = scene.operator.hand().unwrap();
            let way = 0.05 + 0.1 * (hand.compliance_rad_per_n_m() + 0.2);
            let (step, turn) = largest_steps(&scene);
            // A minimum-jerk step over T: speed at most 1.875 way/T, acceleration at most 5.78 way/T²; the release
            // takes 0.4 s.
            let (mut speed, mut acceleration) = (1.875 * way / 0.4, 5.78 * way / 0.16);
            if name == "thesis-knob" {
                // The touch takes 0.05 s for a push of 0.02 N·m. It also starts outside the wall's surface.
                let touch = 0.05 + 0.02 * (hand.compliance_rad_per_n_m() + 0.2);
                speed = speed.max(1.875 * touch / 0.05);
                acceleration = acceleration.max(5.78 * touch / 0.0025);
            }
            if name == "press-wiggle-release" {
                // A sine of 2 Hz, a third of the push, in an envelope that takes 0.25 s.
                let (wiggle, omega) = (
                    0.03 * (hand.compliance_rad_per_n_m() + 0.2),
                    std::f64::consts::TAU * 2.0,
                );
                speed = f64::max(speed, wiggle * (omega + 1.875 / 0.25));
                acceleration = f64::max(
                    acceleration,
                    wiggle * (omega * omega + 2.0 * omega * 1.875 / 0.25 + 5.78 / 0.0625),
                );
            }
            assert!(
                step < speed * 1.01e-4,
                "{name}, {grip}: a step of {step} rad"
            );
            assert!(
                turn < acceleration * 1.05e-4,
                "{name}, {grip}: a turn of {turn} rad/s"
            );
        }
    }
}

#[test]
fn taps_have_no_steps_in_angle_or_speed() {
    for grip in ["grip=light", "grip=medium", "grip=firm"] {
        for velocity in [1.0, 3.0, 8.0] {
            let scene = scene("tap", &[grip, &format!("velocity_rad_per_s={velocity}")]);
            let MotionSpec::Tap(tap) = &scene.operator.motion else {
                panic!("no tap")
            };
            let motion = motion(&scene);
            let peak = (0..10_000)
                .map(|i| (motion.rest_rad(i as f64 * 1e-4) - 0.4).abs())
                .fold(0.0, f64::max);
            let (step, turn) = largest_steps(&scene);
            // No faster than the third harmonic of the tap at full height.
            let omega = 3.0 * std::f64::consts::TAU / super::super::tap::length_s(tap);
            assert!(
                step < peak * omega * 1e-4,
                "{grip}, {velocity}: a step of {step} rad on {peak} rad"
            );
            assert!(
                turn < peak * omega * omega * 1e-4,
                "{grip}, {velocity}: a turn of {turn} rad/s on {peak} rad"
            );
        }
    }
}

#[test]
fn a_press_starts_outside_reaches_the_torque_and_ends_outside() {
    for grip in ["grip=light", "grip=medium", "grip=firm"] {
        for k in [
            "k_desired_n_m_per_rad=0.5",
            "k_desired_n_m_per_rad=5",
            "k_desired_n_m_per_rad=20",
        ] {
            let scene = scene("press-hold", &[grip, k, "push_torque_n_m=0.08"]);
            let path = simulate(&scene, true);
            assert!((path[0].1 - 0.45).abs() < 1e-12, "starts 0.05 rad outside");
            let still = path
                .iter()
                .take_while(|(t, ..)| *t < 0.1)
                .all(|(_, x, _)| (x - 0.45).abs() < 1e-9);
            assert!(still, "rests until the hand starts");
            let (start, end) = scene.hold_window_s().unwrap();
            let window: Vec<f64> = path
                .iter()
                .filter(|(t, ..)| (start..end).contains(t))
                .map(|(_, x, _)| x - 0.5)
                .collect();
            let mean =
                scene.wall.k_desired_n_m_per_rad * window.iter().sum::<f64>() / window.len() as f64;
            assert!((mean - 0.08).abs() < 0.01 * 0.08, "{grip}, {k}: {mean} N·m");
            let (_, x, _) = path.last().unwrap();
            assert!(*x < 0.5, "{grip}, {k}: ends outside, at {x} rad");
        }
    }
}

#[test]
fn wiggling_moves_the_torque_by_its_amplitude_and_stops_before_the_hold() {
    let scene = scene("press-wiggle-release", &[]);
    let hand = scene.operator.hand().unwrap();
    let motion = motion(&scene);
    // Static torque that belongs to the rest point.
    let torque = |t: f64| (motion.rest_rad(t) - 0.5) / (hand.compliance_rad_per_n_m() + 1.0 / 5.0);
    let range = |from: f64, to: f64| {
        let torques = (0..=1000).map(|i| torque(from + (to - from) * f64::from(i) / 1000.0));
        torques.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), t| {
            (low.min(t), high.max(t))
        })
    };
    let (low, high) = range(0.6, 2.1);
    assert!(
        (high - 0.13).abs() < 1e-4 && (low - 0.07).abs() < 1e-4,
        "{low} to {high} N·m"
    );
    let (low, high) = range(2.1, 3.1);
    assert!(
        (low - 0.1).abs() < 1e-12 && (high - 0.1).abs() < 1e-12,
        "quiet: {low} to {high} N·m"
    );
    assert_eq!(
        scene.hold_window_s(),
        Some((0.1 + 0.5 + 1.5 + 0.5, 0.1 + 0.5 + 1.5 + 1.0))
    );
}

#[test]
fn a_tap_reaches_the_wall_at_its_speed_for_every_grip() {
    for grip in ["grip=light", "grip=medium", "grip=firm"] {
        for velocity in [1.0, 3.0, 8.0] {
            let scene = scene("tap", &[grip, &format!("velocity_rad_per_s={velocity}")]);
            let path = simulate(&scene, false);
            let (_, _, speed) = path
                .iter()
                .find(|(_, x, _)| *x >= 0.5)
                .expect("reaches the wall");
            assert!(
                (speed - velocity).abs() < 0.01 * velocity,
                "{grip}: {speed} instead of {velocity} rad/s"
            );
            let top = path.iter().map(|(_, _, v)| v.abs()).fold(0.0, f64::max);
            assert!(
                top < 1.01 * velocity,
                "{grip}: nowhere faster than at the wall, but {top} rad/s"
            );
            let (_, x, v) = path.last().unwrap();
            assert!(
                (x - 0.4).abs() < 2e-3 && v.abs() < 0.05,
                "{grip}: back at rest, but at {x} rad with {v} rad/s"
            );
        }
    }
}

#[test]
fn without_a_motion_the_rest_point_stays_where_the_device_starts() {
    let held = scene("press-hold", &["motion.kind=none"]);
    assert_eq!(motion(&held).rest_rad(0.0), 0.45);
    let held = held.with_overrides(&["initial_angle_rad=0.6"]).unwrap();
    assert_eq!(
        (
            motion(&held).rest_rad(0.0),
            motion(&held).rest_rad(9.0),
            held.start_rad(&motion(&held))
        ),
        (0.6, 0.6, 0.6)
    );
    assert_eq!(held.hold_window_s(), None);
}

#[test]
fn the_device_starts_where_the_hand_starts_unless_told_otherwise() {
    let press = scene("press-hold", &["approach_rad=0.2"]);
    assert!((press.start_rad(&motion(&press)) - 0.3).abs() < 1e-12);
    let press = press.with_overrides(&["initial_angle_rad=0.1"]).unwrap();
    assert_eq!(press.start_rad(&motion(&press)), 0.1);
}

#[test]
fn a_press_that_lost_its_hand_in_code_is_an_error() {
    let mut press = scene("press-hold", &[]);
    press.operator.grip = Grip::None;
    assert!(matches!(press.operator.motion, MotionSpec::RampAndHold(_)));
    let message = RestPath::from_scene(&press).unwrap_err().to_string();
    assert!(
        message.ends_with(
            "operator.motion.kind: no hand holds the device; give operator.grip = \"medium\""
        ),
        "{message}"
    );
}
