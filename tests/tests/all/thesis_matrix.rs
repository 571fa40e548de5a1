//! Tests the results of the comparison in §5.1 of the DLR thesis, cell by cell: three simulated grips (light, medium, firm),
//! encoders of 16,384 and 40,000 counts per turn, default parameters.
//!
//! The bounds are those of `docs/figures.md`. A verdict below [`Verdict::LimitCycle`] means that the knob comes to rest within four
//! encoder counts in every hold. [`Verdict::Active`] then means that the wall gave energy at some time; it is no instability.

use touchstone_control::LawKind;
use touchstone_lab::thesis::{BEYOND, COUNTS, GRIPS, cell};
use touchstone_sim::run::record::{Summary, Verdict};
use touchstone_sim::run::{self};
use touchstone_sim::scene::{Grip, Scene};
use touchstone_tests::thesis;

fn base() -> Scene {
    thesis("thesis-knob")
}

fn at(law: LawKind, k_desired: f64, grip: Grip, counts: u32) -> Summary {
    let scene = cell(&base(), k_desired, law, grip, counts).unwrap();
    run::run(&scene, false).unwrap().summary
}

/// Results of one control law at one desired stiffness for every grip and encoder.
fn all(law: LawKind, k_desired: f64) -> Vec<Summary> {
    let mut runs = Vec::new();
    for counts in COUNTS {
        for grip in GRIPS {
            runs.push(at(law, k_desired, grip, counts));
        }
    }
    assert_eq!(runs.len(), 6, "three grips, two encoders");
    runs
}

fn name(run: &Summary) -> String {
    format!(
        "{:?} {} N·m/rad, {} grip, {:?} counts: {:?}, shows {:?}, rate-hardness {:?}, moves {:?} rad",
        run.law,
        run.k_desired,
        run.grip,
        run.encoder_counts_per_rev,
        run.verdict,
        run.k_displayed,
        run.rate_hardness,
        run.limit_cycle_peak_to_peak
    )
}

#[track_caller]
fn assert_steady(run: &Summary) {
    assert!(run.verdict < Verdict::LimitCycle, "{}", name(run));
}

#[track_caller]
fn assert_shows(run: &Summary, stiffness: f64, share: f64) {
    assert_steady(run);
    let shown = run.k_displayed.expect("a hold");
    assert!(
        (shown / stiffness - 1.0).abs() <= share,
        "{} instead of {stiffness}",
        name(run)
    );
}

#[test]
fn the_matrix_has_the_grips_and_encoders_that_must_be_shown() {
    assert_eq!(COUNTS.len(), 2);
    assert!(COUNTS.contains(&16_384) && COUNTS.contains(&40_000));
    let mut grips = GRIPS.map(Grip::name);
    grips.sort_unstable();
    assert_eq!(grips, ["firm", "light", "medium"]);
}

#[test]
fn spring_tdpa_and_original_sfa_do_not_come_to_rest_at_high_stiffness() {
    for law in [LawKind::Spring, LawKind::Tdpa, LawKind::Sfa] {
        for k_desired in [2.5, 5.0] {
            for run in all(law, k_desired) {
                assert!(run.verdict >= Verdict::LimitCycle, "{}", name(&run));
                // The limit cycle is large: peak to peak more than a hundred counts of the coarse encoder.
                assert!(
                    run.limit_cycle_peak_to_peak.unwrap()
                        > 100.0 * std::f64::consts::TAU / 16_384.0,
                    "{}",
                    name(&run)
                );
            }
        }
    }
}

#[test]
fn the_tdpa_of_the_comparison_uses_the_thesis_observer() {
    let scene = cell(&base(), 5.0, LawKind::Tdpa, GRIPS[0], COUNTS[0]).unwrap();
    assert_eq!(scene.law.observer, touchstone_control::ObserverForm::Thesis);
}

#[test]
fn fba_is_steady_and_shows_the_critical_stiffness_at_high_stiffness() {
    for k_desired in [2.5, 5.0] {
        for run in all(LawKind::Fba, k_desired) {
            assert_shows(&run, 1.0, 0.1);
            assert_eq!(run.verdict, Verdict::Passive, "{}", name(&run));
        }
    }
}

#[test]
fn enhanced_sfa_shows_high_stiffness_at_rest_and_on_first_contact() {
    for k_desired in [2.5, 5.0] {
        for run in all(LawKind::EnhancedSfa, k_desired) {
            assert_shows(&run, k_desired, 0.05);
            let hardness = run.rate_hardness.unwrap();
            // If positions are wrong by up to half a count `q/2`, the force's slope over a depth `w` is wrong by at most the
            // fraction `3 (q/2)/w`. A press at 1.6 rad/s into 5 N·m/rad reaches 7 mrad before the knob turns back.
            let count = std::f64::consts::TAU / run.encoder_counts_per_rev.unwrap();
            let share = 1.5 * count / 0.007;
            assert!(
                (hardness / k_desired - 1.0).abs() <= share,
                "{}",
                name(&run)
            );
        }
    }
}

#[test]
fn at_low_stiffness_all_but_original_sfa_show_what_is_desired() {
    for law in [
        LawKind::Spring,
        // In the thesis TDPA jumps here (Fig. 5.2); the simulated TDPA with the thesis' observer does not (see the claims in the
        // report).
        LawKind::Tdpa,
        LawKind::Fba,
        LawKind::EnhancedSfa,
    ] {
        for run in all(law, 0.5) {
            assert_shows(&run, 0.5, 0.05);
        }
    }
    for run in all(LawKind::Sfa, 0.5) {
        // With an offset below zero the soft spring k_v = 0.8 N·m/rad acts.
        let shown = run.k_displayed.unwrap();
        assert!(shown > 0.5 * 1.2 && shown < 0.8, "{}", name(&run));
    }
}

#[test]
fn enhanced_sfa_below_the_soft_spring_is_the_spring_to_the_bit() {
    for k_desired in [0.2, 0.5, 0.8] {
        let trace = |law| {
            let scene = cell(&base(), k_desired, law, GRIPS[0], COUNTS[0]).unwrap();
            run::run(&scene, true).unwrap().trace.unwrap()
        };
        let (spring, enhanced) = (trace(LawKind::Spring), trace(LawKind::EnhancedSfa));
        let bits = |column: &[f64]| column.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert!(spring.force_n_m.iter().any(|&force| force > 0.09));
        assert_eq!(bits(&spring.force_n_m), bits(&enhanced.force_n_m));
        assert_eq!(bits(&spring.angle_rad), bits(&enhanced.angle_rad));
    }
    // Just above that stiffness the forces differ: the comparison above can fail.
    let force = |law| {
        let scene = cell(&base(), 0.81, law, GRIPS[0], COUNTS[0]).unwrap();
        run::run(&scene, true).unwrap().trace.unwrap().force_n_m
    };
    assert_ne!(force(LawKind::Spring), force(LawKind::EnhancedSfa));
}

#[test]
fn enhanced_sfa_shows_twenty_times_the_critical_stiffness() {
    for counts in COUNTS {
        let run = at(LawKind::EnhancedSfa, BEYOND, Grip::Medium, counts);
        assert_eq!(run.k_desired, 20.0);
        assert_shows(&run, 20.0, 0.05);
        let step = std::f64::consts::TAU / f64::from(counts);
        assert!(
            run.limit_cycle_peak_to_peak.unwrap() <= 4.0 * step,
            "{}",
            name(&run)
        );
    }
}

#[test]
fn without_energy_credit_enhanced_sfa_is_passive_and_shows_at_most_twice_the_coupling() {
    let base = base().with_overrides(&["law.energy_credit_j=0"]).unwrap();
    let k_f = base.law.filter.stiffness_n_m_per_rad;
    let mut largest = 0.0_f64;
    for counts in COUNTS {
        for grip in GRIPS {
            for k_desired in [1.0, 2.5, 5.0, 20.0] {
                let scene = cell(&base, k_desired, LawKind::EnhancedSfa, grip, counts).unwrap();
                let run = run::run(&scene, false).unwrap().summary;
                // Passive: at rest, and the energy of the user's port is never below minus a millionth of the throughput.
                assert_eq!(run.verdict, Verdict::Passive, "{}", name(&run));
                let shown = run.k_displayed.unwrap();
                largest = largest.max(shown);
                // Held through k_f, a force F stores F²/(2 k_f); a slow press into k_de absorbed only F²/(2 k_de).
                assert!(shown <= 2.0 * k_f, "{}", name(&run));
            }
        }
    }
    println!("largest stiffness shown without credit: {largest:.3} N·m/rad, k_f = {k_f}");
}
