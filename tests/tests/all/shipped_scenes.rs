//! Tests that the simulation of every shipped scene file ends with its documented verdict.

use std::path::Path;
use touchstone_control::LawKind;
use touchstone_sim::run::record::{Summary, Verdict};
use touchstone_sim::run::{self};
use touchstone_sim::scene;
use touchstone_tests::thesis;

/// Allowed relative difference of the rate-hardness (slope of the force over the penetration just after contact). The slope is
/// taken over a depth `w`, where the position is wrong by up to half a count `q/2`; so it is wrong by at most `3 (q/2)/w`. A
/// count is 0.157 mrad. A press at 1.6 rad/s into a wall of 5 N·m/rad reaches 7 mrad, and a tap goes deeper.
const HARDNESS: f64 = 3.0 * 0.0785 / 7.0;

fn summary(name: &str) -> Summary {
    run::run(&thesis(name), false).unwrap().summary
}

#[track_caller]
fn assert_close(value: Option<f64>, target: f64, share: f64) {
    let value = value.expect("a value");
    assert!(
        (value / target - 1.0).abs() <= share,
        "{value} is not {target}"
    );
}

#[test]
fn every_shipped_scene_is_judged_here() {
    let mut names = scene::names();
    names.sort_unstable();
    assert_eq!(
        names,
        [
            "free-release",
            "gimbal-knob",
            "identify",
            "low-stiffness",
            "press-hold",
            "press-wiggle-release",
            "tap",
            "thesis-knob",
            "voltage-knob"
        ]
    );
}

#[test]
fn presses_come_to_rest_at_the_desired_stiffness_on_credit() {
    for name in [
        "thesis-knob",
        "press-hold",
        "press-wiggle-release",
        "identify",
    ] {
        let run = summary(name);
        // The knob comes to rest (the verdict is below `LimitCycle`). The energy given beyond that taken stays within the credit
        // of one contact, 20 mJ: if a scene has a touch and a press, the hand does not leave the wall in between.
        assert_eq!(run.verdict, Verdict::Active, "{name}");
        assert!(
            run.energy_user_min > -0.02,
            "{name}: {}",
            run.energy_user_min
        );
        assert_close(run.k_displayed, 5.0, 0.05);
        assert_close(run.rate_hardness, 5.0, HARDNESS);
    }
}

/// Checks the settings that `touchstone tune` found for the small motor, driven by current and by voltage, under every simulated
/// grip. A press of 30 mN·m comes to rest at the wall's stiffness, less than 1.1 times as deep as with an ideal spring, and the
/// energy guard does not act.
#[test]
fn the_small_knob_shows_its_wall_to_every_grip() {
    let knobs = ["gimbal-knob", "voltage-knob"];
    let grips = ["light", "medium", "firm"];
    for (knob, grip) in knobs
        .into_iter()
        .flat_map(|knob| grips.map(|grip| (knob, grip)))
    {
        let scene = scene::Scene::load(knob).unwrap();
        let scene = scene
            .with_overrides(&[&format!("operator.grip={grip}")])
            .unwrap();
        let run = run::run(&scene, false).unwrap().summary;
        assert_eq!(run.verdict, Verdict::Passive, "{grip}");
        assert_close(run.k_displayed, 2.0, 0.05);
        assert!(run.peak_penetration_ratio.unwrap() < 1.1, "{grip}");
        assert_eq!(run.guard_limited_ticks, Some(0), "{grip}");
    }
}

#[test]
fn a_wall_below_the_soft_spring_is_passive() {
    let run = summary("low-stiffness");
    assert_eq!(run.verdict, Verdict::Passive);
    assert_close(run.k_displayed, 0.5, 0.01);
    assert!(
        run.energy_observed_min.is_none(),
        "a plain spring observes nothing"
    );
}

#[test]
fn a_tap_meets_the_desired_stiffness_and_gets_no_energy() {
    let run = summary("tap");
    assert_eq!(run.verdict, Verdict::Passive);
    assert_close(run.rate_hardness, 5.0, HARDNESS);
    assert!(run.contact_ticks > 5, "{}", run.contact_ticks);
    // At the wall's own port a spring of the same stiffness gives some energy in every control period; the law does not.
    let scene = thesis("tap").with_overrides(&["law.kind=spring"]).unwrap();
    let spring = run::run(&scene, false).unwrap().summary;
    assert_eq!(run.energy_true_min, 0.0);
    assert!(spring.energy_true_min < -1e-5, "{}", spring.energy_true_min);
}

#[test]
fn a_knob_released_inside_gets_no_more_than_the_wall_held_there() {
    let run = summary("free-release");
    // The knob starts 0.02 rad inside: a spring of 5 N·m/rad holds 1 mJ there.
    let held = 0.5 * 5.0 * 0.02 * 0.02;
    assert_eq!(
        run.verdict,
        Verdict::Active,
        "it gets some of it, without having put it in"
    );
    assert!(
        run.energy_user_min < 0.0 && run.energy_user_min > -held,
        "{}",
        run.energy_user_min
    );
    assert!(
        run.contact_ticks < 100,
        "it leaves the wall: {}",
        run.contact_ticks
    );
}

#[test]
fn a_recorded_hand_moves_the_knob_in_and_out_of_the_wall() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../shared/data/paddle-hand-motion-200hz.csv");
    if !file.exists() {
        println!("skipped: the recording paddle-hand-motion-200hz.csv is not on this machine");
        return;
    }
    let scene = thesis("thesis-knob").with_recording(&file).unwrap();
    let run = run::run(&scene, true).unwrap();
    // 3046 samples at 200 Hz.
    assert_eq!(run.summary.ticks, 15_225);
    assert_eq!(run.summary.verdict, Verdict::Passive);
    assert_close(run.summary.rate_hardness, 5.0, HARDNESS);
    let trace = run.trace.unwrap();
    let entries = trace
        .force_n_m
        .windows(2)
        .filter(|pair| pair[0] == 0.0 && pair[1] > 0.0)
        .count();
    assert!(entries >= 5, "{entries}");
    let share = run.summary.contact_ticks as f64 / run.summary.ticks as f64;
    // The hand's rest point is inside 45 % of the time; a wall of 5 N·m/rad keeps the knob out for most of it.
    assert!(share > 0.1 && share < 0.45, "{share}");
    // The simulation keeps the recording's scale, and its mean lies on the wall's surface. The recording is smoothed by a
    // Gaussian with a standard deviation of 6.6 ms. So the rest point stays within the recorded values of five samples (25 ms,
    // 3.8 deviations) to either side; 1e-4 rad are allowed for the samples beyond.
    let text = std::fs::read_to_string(&file).unwrap();
    let degrees: Vec<f64> = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').nth(1).unwrap().parse().unwrap())
        .collect();
    let mean = degrees.iter().sum::<f64>() / degrees.len() as f64;
    let angles: Vec<f64> = degrees
        .iter()
        .map(|degree| 0.5 + (degree - mean).to_radians())
        .collect();
    for (index, rest) in trace.rest_rad.iter().step_by(5).enumerate() {
        let near = &angles[index.saturating_sub(5)..(index + 6).min(angles.len())];
        let low = near.iter().copied().fold(f64::INFINITY, f64::min);
        let high = near.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        assert!(
            (low - 1e-4..=high + 1e-4).contains(rest),
            "sample {index}: {rest} is outside {low} to {high}"
        );
    }

    let mut spring = scene;
    spring.law.kind = LawKind::Spring;
    let spring = run::run(&spring, false).unwrap().summary;
    assert_eq!(
        spring.verdict,
        Verdict::Active,
        "5 k_c without control gives energy away"
    );
}
