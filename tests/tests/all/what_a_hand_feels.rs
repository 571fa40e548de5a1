//! Compares the measures of a simulation (such as displayed stiffness) with closed forms, for a spring in f64 with known stiffness
//! and lag.

use touchstone_sim::run::record::{Summary, Verdict};
use touchstone_sim::run::{self};
use touchstone_tests::thesis;

/// Simulates a hand that moves at 4 Hz inside a spring of 0.5 N·m/rad, half of this knob's largest stable stiffness, without
/// encoder and friction. Returns the measured values, such as the displayed stiffness.
fn spring(delay_s: f64) -> Summary {
    let mut scene = thesis("press-wiggle-release")
        .with_overrides(&[
            "law.kind=spring",
            "law.number=f64",
            "wall.k_desired_n_m_per_rad=0.5",
            "operator.motion.wiggle_s=3",
            "operator.motion.wiggle_frequency_hz=4",
            "timing.duration_s=6",
        ])
        .unwrap();
    scene.encoder = None;
    scene.device.friction = None;
    scene.timing.computational_delay_s = delay_s;
    assert_eq!(scene.timing.rate_hz, 1_000);
    run::run(&scene, false).unwrap().summary
}

#[test]
fn a_sampled_spring_lags_by_half_a_tick_and_its_delay_and_by_nothing_else() {
    for delay_s in [0.0, 0.3e-3, 1e-3] {
        let run = spring(delay_s);
        let [found] = run.dynamic_stiffness[..] else {
            panic!("one frequency: {run:?}");
        };
        let lag_deg = 360.0 * 4.0 * (0.5e-3 + delay_s);
        println!("delay {delay_s} s: {found:?}, expected lag {lag_deg}°");
        assert_eq!(found.frequency_hz, 4.0);
        // The amplitude of the mean of two samples a tick apart is smaller by the fraction 1 - cos(0.0126) = 8e-5, and so is that
        // of the mean of two torques in a tick. The remaining error comes from the press' own swing over a fraction of a period.
        assert!((found.modulus_n_m_per_rad / 0.5 - 1.0).abs() < 1e-3);
        assert!((found.phase_deg + lag_deg).abs() < 0.05);
        assert!((run.rate_hardness.unwrap() / 0.5 - 1.0).abs() < 1e-6 || delay_s > 0.0);
    }
}

#[test]
fn a_spring_has_settled_when_it_is_touched_and_a_soft_one_never() {
    let mut press = thesis("press-hold")
        .with_overrides(&[
            "law.kind=spring",
            "law.number=f64",
            "wall.k_desired_n_m_per_rad=0.5",
            // Damps the swing of the finger pad, which a spring does not.
            "device.friction.kinetic_n_m=1e-3",
        ])
        .unwrap();
    press.encoder = None;
    let run = run::run(&press, false).unwrap().summary;
    println!("settled {:?} s after the first touch", run.settle_time);
    // The knob may bounce before the ramp has ended; the spring without an encoder is exact whenever it is touched.
    assert!(run.settle_time.unwrap_or_else(|| panic!("{run:?}")) < 0.5);
    assert_eq!(run.settle_from_ramp_end_s, Some(0.0));
    let soft = thesis("press-hold")
        .with_overrides(&[
            "law.kind=fba",
            "wall.k_desired_n_m_per_rad=5",
            "device.friction.kinetic_n_m=1e-3",
        ])
        .unwrap();
    let soft = run::run(&soft, false).unwrap().summary;
    assert!(soft.verdict < Verdict::LimitCycle, "{soft:?}");
    assert_eq!(soft.settle_time, None);
    // At rest FBA shows 2 c_i/T = 1 N·m/rad. So the hand goes in five times as deep, less the depth by which the spring of its
    // own grip relaxes.
    let ratio = soft.peak_penetration_ratio.unwrap();
    assert!(ratio > 4.0, "{ratio} {soft:?}");
}

#[test]
fn a_spring_gives_its_hand_what_the_hand_has_stored_in_it() {
    let run = spring(0.0);
    let depth = run.peak_penetration_ratio.unwrap() * 0.13 / 0.5;
    let stored = 0.5 * 0.5 * depth * depth;
    // At the wall's port a sampled spring gives back some percent more than it stored, because its force is wrong by k T v/2 at
    // every moment (half a control period `T` late at the speed `v`).
    let share = run.energy_out_wall_worst_window_j / stored;
    println!("stored {stored} J, given back {share} of it at the wall");
    assert!(share > 1.0 && share < 1.2, "{share}");
    // The hand gets less: the device's own damping takes its part.
    assert!(run.energy_out_worst_window_j < run.energy_out_wall_worst_window_j);
    assert!(run.energy_out_worst_window_j > 0.5 * stored);
}

#[test]
fn a_wall_that_is_not_touched_is_not_passive() {
    let mut scene = thesis("free-release");
    scene.device.initial_angle_rad = Some(scene.wall.surface_rad - 0.1);
    let run = run::run(&scene, false).unwrap().summary;
    assert_eq!(run.contact_ticks, 0);
    assert_eq!(run.verdict, Verdict::NoContact);
    assert_eq!(run.rate_hardness, None);
    assert_eq!(run.ripple_rms_n_m, None);
}
