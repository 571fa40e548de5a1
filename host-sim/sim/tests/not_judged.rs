//! Tests that a moving hand is not mistaken for an unstable wall, and that faults visible under a moving hand are still reported.

use std::path::PathBuf;
use touchstone_sim::run;
use touchstone_sim::run::record::{Summary, Verdict};
use touchstone_sim::scene::{Preset, Scene};

/// Writes a recording at 1 kHz of the angle in rad as a function of time in s, and returns the path of the file.
fn recording(name: &str, length_s: f64, angle: impl Fn(f64) -> f64) -> PathBuf {
    let file = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}.csv"));
    let mut text = String::from("time_s,angle_rad\n");
    for n in 0..(1e3 * length_s) as usize {
        let time_s = n as f64 / 1e3;
        text += &format!("{time_s},{:.6}\n", angle(time_s));
    }
    std::fs::write(&file, text).unwrap();
    file
}

fn of(scene: &str, sets: &[&str]) -> Summary {
    let scene = Scene::load(scene).unwrap();
    let scene = scene.with_preset(Preset::Thesis).unwrap();
    let scene = scene.with_overrides(sets).unwrap();
    run::run(&scene, false).unwrap().summary
}

/// Simulates a recorded hand on the thesis' knob, with a spring of the stiffness `k_desired` in N·m/rad as the control law.
fn played(file: &std::path::Path, length_s: f64, k_desired: f64, sets: &[&str]) -> Summary {
    let sets_of_motion = [
        "operator.motion.kind=\"recorded\"".to_owned(),
        format!("operator.motion.file={:?}", file.display().to_string()),
        "law.kind=\"spring\"".to_owned(),
        format!("wall.k_desired_n_m_per_rad={k_desired}"),
        format!("timing.duration_s={length_s}"),
    ];
    let all: Vec<&str> = sets_of_motion
        .iter()
        .map(String::as_str)
        .chain(sets.iter().copied())
        .collect();
    of("thesis-knob", &all)
}

fn sine(hz: f64, time_s: f64) -> f64 {
    libm::sin(std::f64::consts::TAU * hz * time_s)
}

/// Tests that a wall of half the largest stable stiffness is never called unstable while a hand moves it.
#[test]
fn a_soft_wall_is_never_at_fault_for_a_hand_that_moves() {
    let mut unjudged = 0;
    for (name, angle) in [
        (
            "tapping-1",
            &(|t| 0.3 * sine(1.0, t)) as &dyn Fn(f64) -> f64,
        ),
        ("tapping-3", &|t| 0.3 * sine(3.0, t)),
        ("tapping-7", &|t| 0.1 * sine(7.0, t)),
        ("chirp", &|t| 0.2 * sine(0.5 + 0.7 * t, t)),
        ("two-rates", &|t| 0.2 * sine(1.3, t) + 0.05 * sine(6.1, t)),
        ("drift", &|t| 0.05 * t),
    ] {
        let file = recording(name, 6.0, angle);
        for grip in ["light", "medium", "firm"] {
            for end_s in [5.0, 5.87] {
                let grip = format!("operator.grip={grip:?}");
                let run = played(&file, end_s, 0.5, &[&grip]);
                assert!(
                    !matches!(run.verdict, Verdict::LimitCycle | Verdict::Unstable),
                    "{name}, {grip}, {end_s}: {run:?}"
                );
                assert_eq!(
                    run.verdict == Verdict::NotJudged,
                    run.not_judged.is_some(),
                    "{run:?}"
                );
                unjudged += usize::from(run.not_judged.is_some());
            }
        }
    }
    assert!(unjudged >= 24, "{unjudged} of 36");
}

/// Angle of a hand in rad over time in s: it moves in, holds still from 1 to 3 s, then moves in and out at 1 Hz.
fn held_and_then_not(time_s: f64) -> f64 {
    match time_s {
        t if t < 1.0 => 0.4 * (1.0 - libm::cos(std::f64::consts::PI * t)) / 2.0,
        t if t < 3.0 => 0.4,
        t => 0.4 + 0.3 * sine(1.0, t - 3.0),
    }
}

#[test]
fn a_recorded_hold_is_judged_wherever_it_is() {
    let file = recording("held-and-then-not", 5.0, held_and_then_not);
    let soft = played(&file, 5.0, 0.5, &[]);
    assert!(soft.verdict < Verdict::LimitCycle, "{soft:?}");
    // A wall of four times the critical stiffness oscillates while the hand presses it.
    let stiff = played(&file, 5.0, 4.0, &["operator.motion.offset_rad=0.2"]);
    assert!(
        matches!(stiff.verdict, Verdict::LimitCycle | Verdict::Unstable),
        "{stiff:?}"
    );
}

#[test]
fn a_trembling_hand_is_not_the_walls_fault() {
    let steady = of("low-stiffness", &[]);
    assert!(steady.verdict < Verdict::LimitCycle, "{steady:?}");
    let trembling = of("low-stiffness", &["operator.tremor.amplitude_rad=0.05"]);
    assert_eq!(trembling.verdict, Verdict::NotJudged, "{trembling:?}");
    let why = trembling.not_judged.unwrap();
    assert!(why.contains("moves by 100.00 mrad"), "{why}");
    // The wall's oscillation is detected beside a small tremor.
    let own = of(
        "thesis-knob",
        &["law.kind=\"spring\"", "operator.tremor.amplitude_rad=0.001"],
    );
    assert_eq!(own.verdict, Verdict::Unstable, "{own:?}");
}

#[test]
fn a_hold_that_is_too_short_shows_nothing() {
    for (scene, duration) in [
        ("press-hold", "operator.motion.hold_s=0.04"),
        ("low-stiffness", "operator.motion.hold_s=0.01"),
        ("thesis-knob", "operator.motion.hold_s=0.07"),
    ] {
        let run = of(scene, &[duration]);
        assert!(run.contact_ticks > 0, "{run:?}");
        assert_eq!(run.verdict, Verdict::NotJudged, "{run:?}");
        let why = run.not_judged.unwrap();
        assert!(
            why.starts_with("the run shows only ") && why.ends_with("at least 20 ms are needed"),
            "{why}"
        );
    }
}
