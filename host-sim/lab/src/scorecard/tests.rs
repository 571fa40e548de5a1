//! Tests scorecards of walls whose properties are known.

use super::cases::{CASES, Case, Change, Deed, GRIPS, Programme};
use super::measure::{Figures, Limits, Measure};
use super::reference::Reference;
use super::rivals::{RIVALS, Rival};
use super::{Entry, asked, figures, scorecard};
use std::path::Path;
use touchstone_control::choices::{ChangeOfForce, StatesKind};
use touchstone_sim::run::terms::Terms;
use touchstone_sim::scene::Scene;

fn knob(k_desired: f64) -> Scene {
    let mut scene = Scene::load("thesis-knob").expect("a shipped scene");
    scene.wall.k_desired_n_m_per_rad = k_desired;
    scene
}

/// A spring with damping, with the state estimator. With a damping of 0.006 N·m·s/rad it works on every device at five times the
/// stiffness that sampling allows a plain spring.
fn estimated(k_desired: f64, damping: f64) -> Scene {
    let mut scene = Rival::named("spring-damper-estimated")
        .expect("a law")
        .to_tune(&knob(k_desired));
    scene.law.virtual_damping_n_m_s_per_rad = damping;
    scene.law.estimator.bandwidth_hz = 57.96;
    scene.law.estimator.delay_s = 5.327e-4;
    scene.law.estimator.inertia_kg_m2 = 1.166e-4;
    // These settings were tuned without the pulse at the touch.
    scene.law.impact.share_of_momentum = 0.0;
    scene
}

#[test]
fn a_soft_spring_is_what_it_is_set_to() {
    // A spring at half of k_c is passive, so that only sampling causes errors.
    let scene = Rival::named("spring").expect("a law").of(&knob(0.5));
    let (felt, beside) = figures(&scene, &Programme::of(&scene), &CASES[0], true).expect("runs");
    assert!(felt.get(Measure::StiffnessError) < 0.01, "{felt:?}");
    assert!(felt.get(Measure::ModulusError) < 0.01, "{felt:?}");
    // A held force lags by half a tick, 0.72° at 4 Hz.
    assert!(
        (felt.get(Measure::PhaseDeg) - 0.72).abs() < 0.05,
        "{felt:?}"
    );
    assert_eq!(felt.get(Measure::EnergyOutJ), 0.0);
    assert!(beside.settle_from_ramp_end_s.is_some_and(|s| s < 0.05));
    assert!(
        beside
            .motion_at_rest_counts
            .is_some_and(|counts| counts <= 4.0)
    );
}

#[test]
fn what_is_worse_is_found_worse() {
    let programme = |scene: &Scene| Programme::of(scene).shortened();
    let of = |scene: &Scene| {
        figures(scene, &programme(scene), &CASES[0], false)
            .expect("runs")
            .0
    };
    // A plain spring at 5 k_c is lost, and gives out energy.
    let spring = of(&Rival::named("spring").expect("a law").of(&knob(5.0)));
    assert!(spring.get(Measure::EnergyOutJ) > 1e-3, "{spring:?}");
    assert!(spring.get(Measure::StiffnessErrorHeld) > 0.5, "{spring:?}");
    // More damping makes the ramp less like a spring, and adds ripple beyond that of the motion itself.
    let (little, much) = (of(&estimated(5.0, 0.005948)), of(&estimated(5.0, 0.03)));
    for measure in [Measure::RippleRmsNM, Measure::StiffnessError] {
        assert!(
            much.get(measure) > 1.15 * little.get(measure),
            "{measure:?}: {} {}",
            much.get(measure),
            little.get(measure)
        );
    }
    // A force limit below the press: the hand meets a softer wall.
    let mut soft = estimated(5.0, 0.005948);
    soft.law.force_limit_n_m = 0.08;
    let whole = programme(&estimated(5.0, 0.005948));
    let (softened, _) = figures(&soft, &whole, &CASES[0], false).expect("runs");
    assert!(softened.get(Measure::StiffnessErrorHeld) > 0.1);
}

#[test]
fn known_settings_hold_every_device_and_the_difference_damper_does_not() {
    let scene = knob(5.0);
    let entry = |name: &str, scene: Scene| Entry {
        rival: Rival::named(name).expect("a law"),
        scene,
        tuned: false,
    };
    let mut damper = Rival::named("spring-damper").expect("a law").of(&scene);
    damper.law.virtual_damping_n_m_s_per_rad = 0.0084;
    let entries = [
        entry("spring-damper-estimated", estimated(5.0, 0.005948)),
        entry("spring-damper", damper),
    ];
    let mut told = Vec::new();
    let card = scorecard(&scene, &entries, |law| told.push(law.to_owned())).expect("runs");
    assert_eq!(told, ["spring-damper-estimated", "spring-damper"]);
    assert!(card.rows[0].passes, "{:?}", card.rows[0].fails);
    assert_eq!(card.rows[0].cells.len(), CASES.len());
    assert!(!card.rows[1].passes);
    assert!(!card.rows[1].fails.is_empty());
    // The reference spring-damper holds this wall with a whole tick of delay.
    assert_eq!(card.reference.delay_ticks, Some(1.0));
    let text = super::page::text(&card);
    assert!(text.contains("spring-damper fails: "), "{text}");
    // In JSON the figures have the names of a run's results.
    let json = serde_json::to_value(&card).expect("numbers");
    let nominal = &json["rows"][0]["cells"][0];
    assert!(nominal["figures"]["peak_penetration_ratio"].is_number());
    assert!(nominal["figures"]["ripple_rms_n_m"].is_number());
}

/// Largest measure on a device, relative to its limit.
fn worst_share(scene: &Scene, reference: Reference, case: &Case) -> f64 {
    let (felt, _) = figures(scene, &Programme::of(scene), case, false).expect("runs");
    let shares = felt.shares(&reference.limits(case));
    shares.into_iter().fold(0.0, f64::max)
}

/// The thesis' knob with a file of settings from the documentation.
fn knob_with(settings: &str) -> Scene {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../docs/tuning/")
        .join(settings);
    knob(5.0).with_settings(&file).expect("a settings file")
}

#[test]
fn twenty_critical_stiffnesses_hold_on_every_device() {
    let scene = knob_with("twenty-critical.toml");
    assert_eq!(scene.wall.k_desired_n_m_per_rad, 20.0);
    // Limit of the ripple that `touchstone scorecard` computes for this wall: 0.6 of the reference spring-damper's ripple.
    let reference = Reference {
        limit_n_m: 3.93e-3,
        ..Reference::none()
    };
    assert_eq!(asked(&scene).count(), CASES.len());
    for case in &CASES {
        let share = worst_share(&scene, reference, case);
        assert!(share <= 1.0, "{}: {share} of a limit", case.name);
    }
}

/// Checks that the settings of one scene work at every control rate. The offset's pace is set per millisecond, not per tick, and
/// the estimator predicts at most two ticks.
#[test]
fn tuned_walls_hold_at_every_rate_without_being_tuned_again() {
    for (name, wall, touch) in [
        (
            "twenty-critical.toml",
            knob_with("twenty-critical.toml"),
            2.0,
        ),
        ("what ships", knob(14.0), 1.3),
    ] {
        for rate_hz in [1000, 2000, 5000, 10_000] {
            let mut scene = wall.clone();
            scene.timing.rate_hz = rate_hz;
            let (felt, beside) =
                figures(&scene, &Programme::of(&scene), &CASES[0], false).expect("runs");
            let press = felt.get(Measure::PeakPenetrationRatio);
            assert!(
                press < 1.05 && beside.touch_penetration_ratio < touch,
                "{name} at {rate_hz} Hz: press {press}, touch {}",
                beside.touch_penetration_ratio
            );
        }
    }
}

#[test]
fn fifty_critical_stiffnesses_hold_to_half_a_tick_and_no_further() {
    let scene = knob_with("fifty-critical.toml");
    assert_eq!(scene.wall.k_desired_n_m_per_rad, 50.0);
    // Limit of the ripple that `touchstone scorecard` computes for this wall: 0.6 of the reference spring-damper's ripple.
    let reference = Reference {
        limit_n_m: 7.62e-3,
        ..Reference::none()
    };
    let asked: Vec<&Case> = asked(&scene).collect();
    assert_eq!(asked.len(), 3);
    for case in asked {
        let share = worst_share(&scene, reference, case);
        assert!(share <= 1.0, "{}: {share} of a limit", case.name);
    }
    // With a whole tick of delay the wall is lost, as the matrices predict.
    let late = CASES.iter().find(|case| case.change == Change::Delay(1.0));
    assert!(worst_share(&scene, reference, late.expect("a case")) > 1.0);
    let grips = crate::certify::CertifyOptions {
        family: crate::certify::hands::Family::Grips,
        ..Default::default()
    };
    let said = crate::certify::certify(&scene, &grips).expect("a law");
    assert_eq!(said.verdict, crate::certify::Verdict::Stable);
    let most_s = said.margins.expect("asked for").delay_s;
    assert!((5e-4..6e-4).contains(&most_s), "{most_s}");
}

#[test]
fn every_motion_is_measured_over_whole_periods() {
    let scene = knob(5.0);
    let programme = Programme::of(&scene);
    for deed in programme.deeds() {
        let scene = programme.scene(&scene, GRIPS[0], deed);
        let terms = Terms::of(&scene);
        match deed {
            Deed::Press => assert!(terms.press.is_some()),
            Deed::Move(frequency_hz) => {
                let wiggle = terms.wiggle.expect("long enough");
                let periods =
                    (wiggle.window.1 - wiggle.window.0) as f64 * terms.period_s * frequency_hz;
                assert!(periods > 0.99 && (periods - periods.round()).abs() < 0.01);
                assert!(wiggle.window.1 <= terms.ticks);
            }
        }
    }
}

#[test]
fn a_case_changes_the_device_and_not_what_its_law_is_told() {
    let scene = estimated(5.0, 0.005948);
    for case in &CASES {
        let changed = case.of(&scene);
        assert_eq!(changed.law, scene.law, "{}", case.name);
        assert_eq!(
            case.change == Change::Nothing,
            changed == scene,
            "{}",
            case.name
        );
    }
    let late = Case {
        name: "",
        change: Change::Delay(0.5),
    };
    assert_eq!(late.of(&scene).timing.computational_delay_s, 5e-4);
    assert!(late.is_late() && !CASES[0].is_late());
    // For very stiff walls only the nominal inertia and up to half a tick of delay count.
    assert_eq!(asked(&knob(20.0)).count(), CASES.len());
    assert_eq!(asked(&knob(50.0)).count(), 3);
}

#[test]
fn limits_are_shares_and_counts() {
    let reference = Reference {
        limit_n_m: 1e-3,
        ..Reference::none()
    };
    let coarse = reference.limits(&CASES[1]);
    assert!((coarse.ripple_n_m - 1e-3 / 0.4096).abs() < 1e-12);
    let limits = Limits::new(false, 1e-3);
    let mut felt = Figures::NONE;
    felt.raise(Measure::PeakPenetrationRatio, 1.05);
    felt.raise(Measure::PhaseDeg, 24.0);
    felt.raise(Measure::PhaseDeg, 6.0);
    let shares = felt.shares(&limits);
    assert!((shares[0] - 0.5).abs() < 1e-9);
    assert_eq!(shares[5], 2.0, "the worst stays");
    // Any energy is too much; rounding does not count.
    felt.raise(Measure::EnergyOutJ, 1e-12);
    assert_eq!(felt.shares(&limits)[7], 0.0);
    felt.raise(Measure::EnergyOutJ, 1e-8);
    assert!(felt.shares(&limits)[7] > 1.0);
    // NaN counts as the worst value.
    felt.raise(Measure::ModulusError, f64::NAN);
    assert!(felt.get(Measure::ModulusError).is_infinite());
}

#[test]
fn every_law_has_a_name_of_its_own_and_runs_in_the_shipped_scene() {
    let scene = knob(1.0);
    for rival in &RIVALS {
        assert_eq!(Rival::named(rival.name).expect("its name").name, rival.name);
        let own = rival.of(&scene);
        let measured = own.law.states == StatesKind::Measured;
        assert!(measured || rival.estimated, "{}", rival.name);
        let programme = Programme::of(&own).shortened();
        figures(&own, &programme, &CASES[0], false).expect(rival.name);
    }
    let wrong = Rival::named("spring-dampr")
        .expect_err("no law")
        .to_string();
    assert!(wrong.contains("did you mean spring-damper?"), "{wrong}");
}

#[test]
fn a_press_leaves_the_wall_some_of_its_torque() {
    let mut weak = knob(1.0);
    let whole = Programme::of(&weak).press;
    weak.device.torque_limit_n_m = Some(0.05);
    let press = Programme::of(&weak).press;
    assert!((press.push_torque_n_m - 0.03).abs() < 1e-12);
    let touch = whole.touch_torque_n_m / whole.push_torque_n_m * press.push_torque_n_m;
    assert!((press.touch_torque_n_m - touch).abs() < 1e-12);
    // The law's own limit counts if it is lower than the motor's; a strong motor changes nothing.
    weak.law.force_limit_n_m = 0.02;
    assert!((Programme::of(&weak).press.push_torque_n_m - 0.012).abs() < 1e-12);
    weak = knob(1.0);
    weak.device.torque_limit_n_m = Some(10.0);
    assert_eq!(Programme::of(&weak).press, whole);
}

#[test]
fn a_tuned_law_is_behind_a_guard_that_is_told_no_more_than_there_is() {
    let mut scene = knob(5.0);
    scene.device.damping_n_m_s_per_rad = 3e-4;
    scene.device.torque_limit_n_m = Some(0.2);
    scene.timing.computational_delay_s = 2e-4;
    for rival in &RIVALS {
        let law = |scene: &Scene| rival.to_tune(scene).law;
        let plain = law(&scene);
        assert!(plain.guard.on, "{}", rival.name);
        assert_eq!(plain.guard.damping_n_m_s_per_rad, 3e-4);
        assert_eq!(plain.guard.delay_s, 2e-4);
        assert_eq!(plain.force_limit_n_m, 0.2);
        // The scene's own guard settings stay if they are more cautious.
        let mut said = scene.clone();
        said.law.guard.damping_n_m_s_per_rad = 2.4e-4;
        said.law.guard.delay_s = 7e-4;
        said.law.guard.lag_s = 1e-4;
        said.law.guard.change = ChangeOfForce::Measured;
        said.law.guard.on = false;
        let kept = law(&said).guard;
        assert_eq!(
            (kept.damping_n_m_s_per_rad, kept.delay_s, kept.lag_s),
            (2.4e-4, 7e-4, 1e-4)
        );
        assert_eq!(kept.change, ChangeOfForce::Measured);
        assert!(kept.on);
        // Less cautious values are replaced.
        said.law.guard.damping_n_m_s_per_rad = 9e-4;
        said.law.guard.delay_s = 1e-4;
        let kept = law(&said).guard;
        assert_eq!((kept.damping_n_m_s_per_rad, kept.delay_s), (3e-4, 2e-4));
        said.law.guard.on = true;
        rival.to_tune(&said).settings().expect(rival.name);
    }
}

#[test]
fn the_limit_of_ripple_does_not_grow_with_a_rival_that_shakes() {
    let quiet = Reference::of(&knob(5.0)).expect("runs");
    let mut noisy = knob(5.0);
    noisy.sensor.noise = Some(touchstone_sim::scene::SensorNoise::default());
    assert_eq!(Reference::of(&noisy).expect("runs"), quiet);
    // A spring-damper on differences of counts at 10 kHz has ten times the ripple and still holds the wall. The limit stays at a
    // tenth of the press.
    for k_desired in [1.0, 5.0, 20.0, 50.0, 200.0] {
        for rate_hz in [500, 1000, 10_000] {
            let mut scene = knob(k_desired);
            scene.timing.rate_hz = rate_hz;
            let press = Programme::of(&scene).press.push_torque_n_m;
            let reference = Reference::of(&scene).expect("runs");
            for case in &CASES {
                let limit = reference.limits(case).ripple_n_m;
                assert!(
                    limit > 0.0 && limit <= 0.1 * press,
                    "{k_desired} {rate_hz} {}: {limit}",
                    case.name
                );
            }
        }
    }
}
