//! Tests the shipped wall with three simulated grips (light, medium, firm) and, one change at a time, a coarser encoder, half and
//! double inertia and damping, and up to a control period of delay. A hand presses the wall, moves along it, and lets go.

use touchstone_control::Settings;
use touchstone_sim::run::record::{Summary, Verdict};
use touchstone_sim::run::{self};
use touchstone_sim::scene::{Preset, Scene};

const GRIPS: [&str; 3] = ["light", "medium", "firm"];
/// Test cases: a change of the simulation's settings, and the resulting delay in seconds.
const CASES: [(&str, f64); 9] = [
    ("timing.computational_delay_s=0", 0.0),
    ("encoder.counts_per_rev=16384", 0.0),
    ("device.inertia_kg_m2=5e-5", 0.0),
    ("device.inertia_kg_m2=2e-4", 0.0),
    ("device.damping_n_m_s_per_rad=2e-4", 0.0),
    ("device.damping_n_m_s_per_rad=8e-4", 0.0),
    ("timing.computational_delay_s=1e-4", 1e-4),
    ("timing.computational_delay_s=5e-4", 5e-4),
    ("timing.computational_delay_s=1e-3", 1e-3),
];
/// Changes that give a simulation the dry friction and encoder of the simulated knob in the DLR thesis.
const KNOB: [&str; 2] = [
    "device.friction.kinetic_n_m=3e-4",
    "encoder.counts_per_rev=40000",
];

fn scene(name: &str, grip: &str, case: &str, more: &[&str]) -> Scene {
    let grip = format!("operator.grip={grip}");
    let sets = [&[grip.as_str(), case], more].concat();
    Scene::load(name).unwrap().with_overrides(&sets).unwrap()
}

fn summary(scene: &Scene) -> Summary {
    run::run(scene, false).unwrap().summary
}

#[test]
fn the_shipped_law_is_the_defaults() {
    // The scene's length of an encoder count in rad equals the default one except for the last digit, so it is not compared.
    let rows = |scene: &Scene| Settings {
        position: Settings::default().position,
        ..scene.settings().unwrap()
    };
    let shipped = Scene::load("thesis-knob").unwrap();
    assert_eq!(rows(&shipped), Settings::default());
    let thesis = shipped.with_preset(Preset::Thesis).unwrap();
    assert_eq!(rows(&thesis), Settings::thesis());
}

#[test]
fn a_press_is_met_at_once_by_every_grip_in_every_case() {
    for (case, delay_s) in CASES {
        for grip in GRIPS {
            let run = summary(&scene(
                "press-hold",
                grip,
                KNOB[0],
                &[&KNOB[1..], &[case]].concat(),
            ));
            let (peak, shown) = (
                run.peak_penetration_ratio.unwrap(),
                run.k_displayed.unwrap_or(f64::NAN),
            );
            println!(
                "{grip:<6} {case:<36} {:<8} peak {peak:.3}, shown {shown:.3}, settled {:?} s, worst window {:.2} mJ, account {:.2} mJ",
                run.verdict_name(),
                run.settle_from_ramp_end_s,
                1e3 * run.energy_out_worst_window_j,
                1e3 * run.guard_account_min_j.unwrap(),
            );
            assert_eq!(run.verdict, Verdict::Passive);
            assert!(peak <= if delay_s < 5e-4 { 1.1 } else { 1.3 });
            assert!((shown / 5.0 - 1.0).abs() <= 0.05);
            assert!(run.settle_from_ramp_end_s.unwrap() <= 0.05);
            assert_eq!(run.energy_out, 0.0);
            assert_eq!(run.guard_limited_ticks, Some(0));
            assert_eq!(run.guard_tripped_s, None);
        }
    }
}

/// Checks a press that begins with a light touch of 0.02 N·m within 50 ms. A knob's momentum drives the knob deeper than the
/// press alone would, but at most to 1.4 times the depth of the press in an ideal spring.
#[test]
fn a_brisk_touch_goes_no_deeper_than_its_momentum() {
    let mut worst: f64 = 0.0;
    for (case, _) in CASES {
        for grip in GRIPS {
            let run = summary(&scene("thesis-knob", grip, case, &[]));
            let peak = run.peak_penetration_ratio.unwrap();
            println!("{grip:<6} {case:<36} {} peak {peak:.3}", run.verdict_name());
            assert_eq!(run.verdict, Verdict::Passive);
            worst = worst.max(peak);
        }
    }
    assert!(worst <= 1.4, "{worst}");
}

#[test]
fn a_moving_hand_feels_the_stiffness() {
    for (case, delay_s) in CASES {
        for grip in GRIPS {
            for hz in [1.0, 2.0, 4.0] {
                let frequency = format!("operator.motion.wiggle_frequency_hz={hz}");
                let motion = [
                    frequency.as_str(),
                    "operator.motion.wiggle_s=3",
                    "timing.duration_s=6",
                    KNOB[0],
                    KNOB[1],
                ];
                // The case comes last, so that it overrides the others.
                let run = summary(&scene(
                    "press-wiggle-release",
                    grip,
                    motion[0],
                    &[&motion[1..], &[case]].concat(),
                ));
                let [found] = run.dynamic_stiffness[..] else {
                    panic!("{grip} {case}: {run:?}")
                };
                println!(
                    "{grip:<6} {case:<36} {hz} Hz: {:.3} N·m/rad, {:.2}°, ripple {:.2} mN·m",
                    found.modulus_n_m_per_rad,
                    found.phase_deg,
                    1e3 * run.ripple_rms_n_m.unwrap(),
                );
                assert!(
                    (found.modulus_n_m_per_rad / 5.0 - 1.0).abs() <= 0.1,
                    "{delay_s}"
                );
                assert!(found.phase_deg.abs() <= 12.0);
                assert_eq!(run.guard_limited_ticks, Some(0));
            }
        }
    }
}

/// Checks that the energy guard changes no bit of the results in any shipped simulation (scene file).
#[test]
fn the_guard_leaves_the_shipped_scenes_alone() {
    for name in touchstone_sim::scene::names() {
        let on = Scene::load(name).unwrap();
        assert!(on.law.guard.on, "{name}");
        let off = on.with_overrides(&["law.guard.on=false"]).unwrap();
        let (on, off) = (
            run::run(&on, true).unwrap().trace.unwrap(),
            run::run(&off, true).unwrap().trace.unwrap(),
        );
        assert_eq!(on.force_n_m, off.force_n_m, "{name}");
        assert_eq!(on.angle_rad, off.angle_rad, "{name}");
    }
}

/// Checks that the same settings work at other control rates, because they are in seconds and not in control periods.
#[test]
fn the_same_settings_serve_other_rates() {
    for rate_hz in [1_000, 2_000, 5_000, 10_000] {
        let rate = format!("timing.rate_hz={rate_hz}");
        for grip in GRIPS {
            let run = summary(&scene(
                "press-hold",
                grip,
                KNOB[0],
                &[&KNOB[1..], &[&rate]].concat(),
            ));
            let peak = run.peak_penetration_ratio.unwrap();
            println!(
                "{rate_hz} Hz, {grip}: {} peak {peak:.3}",
                run.verdict_name()
            );
            assert_eq!(run.verdict, Verdict::Passive);
            assert!(peak <= 1.1);
        }
    }
}
