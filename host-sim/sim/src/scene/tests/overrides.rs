//! Tests of changing a scene's fields by `--set`.

use super::*;
use touchstone_control::LawKind;

fn knob() -> Scene {
    Scene::load("thesis-knob").expect("a shipped scene")
}

fn set(sets: &[&str]) -> Scene {
    knob()
        .with_overrides(sets)
        .unwrap_or_else(|error| panic!("{error}"))
}

#[track_caller]
fn refused(sets: &[&str], expected: &str) {
    assert_eq!(
        knob()
            .with_overrides(sets)
            .expect_err("this must be refused")
            .to_string(),
        expected
    );
}

/// The table `environment` is also called `feel`, as in a scene's file.
#[test]
fn a_feel_is_an_environment() {
    let (feel, named) = ("feel.detents.per_rev", "environment.detents.per_rev");
    let changed = |key: &str| set(&[&format!("{key}=7"), "environment.detents.strength_n_m=0.02"]);
    assert_eq!(changed(feel).environment, changed(named).environment);
    assert_eq!(path_of(feel).as_deref(), Some(named));
    assert_eq!(
        changed(feel)
            .with_overrides(&["feel=none"])
            .unwrap()
            .environment,
        None
    );
    refused(
        &["feel.detents.per_revs=7"],
        "--set feel.detents.per_revs=7: unknown field; did you mean per_rev?",
    );
}

#[test]
fn full_paths_and_unambiguous_ends() {
    let scene = set(&[
        "device.inertia_kg_m2=2e-4",
        "k_soft_n_m_per_rad = .5",
        "filter.mass_kg_m2=1",
        "law.kind=tdpa",
        "name=\"x\"",
    ]);
    let mut expected = knob();
    expected.device.inertia_kg_m2 = 2e-4;
    expected.law.k_soft_n_m_per_rad = 0.5;
    expected.law.filter.mass_kg_m2 = 1.0;
    expected.law.kind = LawKind::Tdpa;
    expected.name = "x".into();
    assert_eq!(scene, expected);
}

#[test]
fn the_last_word_wins_and_the_check_comes_after_all() {
    assert_eq!(set(&["rate_hz=500", "rate_hz=2000"]).timing.rate_hz, 2000);
    // Before the last change, the break-away torque is below the kinetic friction.
    let friction = set(&["static_n_m=2e-3", "kinetic_n_m=3e-3", "static_n_m=4e-3"])
        .device
        .friction
        .unwrap();
    assert_eq!((friction.kinetic_n_m, friction.static_n_m()), (3e-3, 4e-3));
}

#[test]
fn a_break_away_torque_that_was_not_given_follows_the_kinetic_one() {
    assert_eq!(
        set(&["kinetic_n_m=5e-3"])
            .device
            .friction
            .unwrap()
            .static_n_m(),
        5e-3
    );
}

#[test]
fn none_takes_effects_away_and_a_value_brings_them() {
    let scene = set(&["encoder=none", "friction=none", "torque_limit_n_m=none"]);
    assert_eq!(
        (
            scene.encoder,
            scene.device.friction,
            scene.device.torque_limit_n_m
        ),
        (None, None, None)
    );
    let scene = Scene::load("press-hold")
        .unwrap()
        .with_overrides(&["counts_per_rev=16384"])
        .unwrap();
    assert_eq!(
        scene.encoder,
        Some(Encoder {
            counts_per_rev: 16384.0
        })
    );
}

#[test]
fn grip_and_hand_replace_each_other() {
    let scene = set(&["operator.hand.inertia_kg_m2=1e-5"]);
    let expected = Hand {
        inertia_kg_m2: 1e-5,
        ..Grip::Medium.hand().unwrap()
    };
    assert_eq!(
        (scene.operator.grip, scene.operator.hand()),
        (Grip::Custom, Some(expected))
    );
    let scene = scene.with_overrides(&["grip=firm"]).unwrap();
    assert_eq!(
        (scene.operator.grip, scene.operator.hand),
        (Grip::Firm, None)
    );
    // The grip is changed first, and the single value then changes the values of the new grip.
    let scene = set(&["grip=light", "operator.hand.inertia_kg_m2=1e-5"]);
    assert_eq!(
        scene.operator.hand(),
        Some(Hand {
            inertia_kg_m2: 1e-5,
            ..Grip::Light.hand().unwrap()
        })
    );
}

#[test]
fn a_new_motion_keeps_what_both_have() {
    let scene = set(&["start_s=0.3", "motion.kind=tap", "velocity_rad_per_s=2"]);
    let MotionSpec::Tap(tap) = scene.operator.motion else {
        panic!("{:?}", scene.operator.motion)
    };
    assert_eq!(
        tap,
        Tap {
            start_s: 0.3,
            velocity_rad_per_s: 2.0,
            approach_rad: 0.05
        }
    );
}

#[test]
fn an_option_of_its_own_is_quoted_in_errors() {
    let scene = knob()
        .with_option("wall.k_desired_n_m_per_rad", "20", "--k-desired 20")
        .unwrap();
    assert_eq!(scene.wall.k_desired_n_m_per_rad, 20.0);
    let error = knob()
        .with_option("law.kind", "tpda", "--law tpda")
        .unwrap_err()
        .to_string();
    assert_eq!(
        error,
        "--law tpda: unknown value \"tpda\"; did you mean tdpa?"
    );
}

#[test]
fn bad_keys() {
    refused(
        &["inertia"],
        "--set inertia: no value; write --set KEY=VALUE, e.g. --set wall.k_desired_n_m_per_rad=20",
    );
    refused(
        &["damping_n_m_s_per_rad=1e-3"],
        "--set damping_n_m_s_per_rad=1e-3: several fields end so; write device.damping_n_m_s_per_rad, \
         environment.damper.damping_n_m_s_per_rad, law.filter.damping_n_m_s_per_rad, law.estimator.damping_n_m_s_per_rad, law.guard.damping_n_m_s_per_rad or operator.hand.damping_n_m_s_per_rad",
    );
    refused(
        &["kind=tap"],
        "--set kind=tap: several fields end so; write law.kind or operator.motion.kind",
    );
    refused(
        &["surfce_rad=1"],
        "--set surfce_rad=1: unknown field; did you mean surface_rad?",
    );
    refused(
        &["wall.surfce_rad=1"],
        "--set wall.surfce_rad=1: unknown field; did you mean surface_rad?",
    );
    refused(
        &["gravity=1"],
        "--set gravity=1: unknown field; see the scene's fields with --print",
    );
    refused(
        &["encoder=4096"],
        "--set encoder=4096: encoder is a table; set a field of it: encoder.counts_per_rev",
    );
    refused(
        &["inertia_g_cm2=100"],
        "--set inertia_g_cm2=100: wrong unit, this field is in kg·m²; write inertia_kg_m2 = 1e-5",
    );
    refused(
        &["motion.velocity_rad_per_s=2"],
        "--set motion.velocity_rad_per_s=2: the motion `touch-and-press` has no such field; remove it, or use it with tap",
    );
}

#[test]
fn bad_values() {
    refused(
        &["device.inertia_kg_m2=-1"],
        "--set device.inertia_kg_m2=-1: must be above 0, is -1; give the device's moment of inertia in kg·m²",
    );
    refused(
        &["surface_rad=nan"],
        "--set surface_rad=nan: must be a finite number, is NaN; give the wall's surface in rad",
    );
    refused(
        &["surface_rad=none"],
        "--set surface_rad=none: must be a number, is \"none\"; give the wall's surface in rad",
    );
    refused(
        &["rate_hz=1e3"],
        "--set rate_hz=1e3: must be a whole number, is 1000.0; give the control rate in Hz",
    );
    refused(
        &["law.kind=tpda"],
        "--set law.kind=tpda: unknown value \"tpda\"; did you mean tdpa?",
    );
    refused(
        &["static_n_m=1e-4"],
        "--set static_n_m=1e-4: must be at least kinetic_n_m, is 0.0001 below 0.0003; write static_n_m = 0.0003 or leave it out",
    );
}

#[test]
fn a_change_in_code_is_checked_and_named_by_its_value() {
    let text = "name = \"small\"\n[timing]\nduration_s = 2.0\n[operator]\ngrip = \"medium\"\n";
    let scene = Scene::parse(text, std::path::Path::new("small.toml")).unwrap();
    let stiffer = scene
        .with(|scene| scene.wall.k_desired_n_m_per_rad = 7.0)
        .unwrap();
    assert_eq!(stiffer.wall.k_desired_n_m_per_rad, 7.0);
    assert_eq!(stiffer.operator, scene.operator);
    let refused = scene
        .with(|scene| scene.wall.k_desired_n_m_per_rad = -7.0)
        .unwrap_err()
        .to_string();
    assert!(
        refused.starts_with("wall.k_desired_n_m_per_rad = -7.0: must be"),
        "{refused}"
    );
    // Fields that were not changed keep their line for error messages.
    let kept = stiffer.error("timing.duration_s", "no", "yes").to_string();
    assert_eq!(kept, "small.toml:3: timing.duration_s: no; yes");
}
