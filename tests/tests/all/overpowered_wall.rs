//! A hand that slowly presses harder than the motor goes deep into the wall. There the knob must stand still in the hand, and the wall
//! must be where it was drawn once the knob is outside again.
//!
//! A soft grip that presses with 0.7 N·m pushes the knob more than a turn through the wall, faster than the surface gives way. There the
//! knob swings, and the test prints it too:
//! `cargo test -p touchstone-tests overpowered_wall:: -- --nocapture`.

use touchstone_control::{Controller, Fixed32, Force, Position, Settings, Si};
use touchstone_sim::run;
use touchstone_sim::scene::Scene;

/// The torque limit of the scene `thesis-knob`, N·m.
const LIMIT: f64 = 0.5;

/// The knob's motion in the last half second of a press.
struct Held {
    /// Largest speed, rad/s.
    speed: f64,
    /// Least and largest torque, N·m.
    torque: (f64, f64),
}

/// Presses a wall of `stiffness` in N·m/rad with `torque` in N·m for 4 s, on the thesis' knob with a multiple of its inertia.
fn pressed(grip: &str, stiffness: u32, torque: f64, inertia: f64) -> Held {
    let sets = [
        format!("operator.grip={grip}"),
        format!("wall.k_desired_n_m_per_rad={stiffness}"),
        format!("device.inertia_kg_m2={}", 1e-4 * inertia),
        format!("operator.motion.push_torque_n_m={torque}"),
        "operator.motion.ramp_s=1.5".into(),
        "operator.motion.hold_s=4".into(),
        "timing.duration_s=8.5".into(),
    ];
    let scene = Scene::load("thesis-knob")
        .unwrap()
        .with_overrides(&sets)
        .unwrap();
    let trace = run::run(&scene, true).unwrap().trace.unwrap();
    // The touch begins at 0.1 s, takes 0.05 s and lasts 2 s. Then come the ramp and the hold.
    let end = 0.1 + 0.05 + 2.0 + 1.5 + 4.0;
    let mut held = Held {
        speed: 0.0,
        torque: (f64::MAX, 0.0),
    };
    for (index, time) in trace.time_s.iter().enumerate() {
        if (end - 0.5..end).contains(time) {
            held.speed = held.speed.max(trace.velocity_rad_per_s[index].abs());
            let torque = trace.force_n_m[index];
            held.torque = (held.torque.0.min(torque), held.torque.1.max(torque));
        }
    }
    held
}

#[test]
fn a_hand_that_slowly_overpowers_the_motor_is_not_shaken() {
    let mut shaken = Vec::new();
    println!("grip | N·m/rad | pushed, N·m | inertia | speed, rad/s | torque, N·m");
    for grip in ["medium", "firm"] {
        for stiffness in [5, 10, 14] {
            for torque in [0.55, 0.7] {
                for inertia in [1.0, 0.5] {
                    let held = pressed(grip, stiffness, torque, inertia);
                    let (least, most) = held.torque;
                    println!(
                        "{grip} | {stiffness} | {torque} | {inertia} | {:.2} | {least:.3} to {most:.3}",
                        held.speed
                    );
                    let is_pushed_through = grip == "medium" && torque > 0.6;
                    if is_pushed_through {
                        continue;
                    }
                    if held.speed >= 0.5 || least <= 0.8 * LIMIT || most > LIMIT {
                        shaken.push((grip, stiffness, torque, inertia, held.speed, least));
                    }
                }
            }
        }
    }
    assert!(shaken.is_empty(), "{shaken:?}");
}

/// A wall of 5 N·m/rad with a limit of 0.5 N·m, without what depends on speed: its force shows where its surface is.
fn still() -> Controller<Fixed32> {
    let mut settings = Settings {
        law: touchstone_control::LawKind::Spring,
        states: touchstone_control::StatesKind::Measured,
        k_desired: Si::lit("5"),
        force_limit: Si::lit("0.5"),
        ..Settings::default()
    };
    settings.impact.momentum = Si::ZERO;
    // The guard must not limit the force here.
    settings.guard.capacity = Si::lit("0.1");
    Controller::new(&settings).unwrap()
}

/// Moves the wall's device to a depth in mrad, in steps of at most 1 mrad, and returns the last force in mN·m.
fn moved(wall: &mut Controller<Fixed32>, from: i32, to: i32) -> f64 {
    let mut at = from;
    let mut force = Force::zero();
    while at != to {
        at += (to - at).signum();
        let e = Position::from_si(Si::from_num(f64::from(at) / 1e3)).unwrap();
        force = wall.tick(e);
    }
    1e3 * force.0.to_num::<f64>()
}

#[test]
fn the_surface_gives_way_goes_back_with_the_device_and_is_whole_outside() {
    let mut wall = still();
    assert_eq!(moved(&mut wall, -5, 100).round(), 500.0, "at the limit");
    assert_eq!(
        moved(&mut wall, 100, 90).round(),
        450.0,
        "not yet given way"
    );
    assert_eq!(moved(&mut wall, 90, 400).round(), 500.0, "deep");
    let deepest = 1e3 * wall.surface.deepest.0.to_num::<f64>();
    let given = 1e3 * wall.surface.given.0.to_num::<f64>();
    assert!((deepest - 125.0).abs() < 1.0 && (given + deepest - 400.0).abs() < 1.0);
    assert_eq!(moved(&mut wall, 400, 200), 0.0, "outside the surface");
    let force = moved(&mut wall, 200, 250);
    assert!(
        (force - 250.0).abs() < 6.0,
        "again inward, from there: {force}"
    );
    moved(&mut wall, 250, -5);
    assert_eq!(moved(&mut wall, -5, 50).round(), 250.0, "as drawn");
}
