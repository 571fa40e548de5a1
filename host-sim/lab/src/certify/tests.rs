//! Tests that the certificate's matrices move in the same way as the real control laws and plants.

use super::contact::Contact;
use super::estimator::Estimator;
use super::law::{Offset, enhanced};
use super::linear_law::LinearLaw;
use super::plant::{Clock, Mechanics, sampled};
use super::*;
use nalgebra::DVector;
use std::collections::VecDeque;
use touchstone_control::filter::MassState;
use touchstone_control::law::{
    Augmented, Contact as Phase, EnhancedSfa, EnhancedState, Law as _, Sample,
};
use touchstone_control::{AnyLaw, Choice as _, Controller, Energy, Force, Position, StatesKind};
use touchstone_sim::scene::Preset;
use touchstone_world::plant::{HeldLinear, MEDIUM, State, Stepper};

fn scene(regulate: &str) -> Scene {
    let sets = [
        "law.kind=enhanced-sfa",
        "law.number=f64",
        "law.k_soft_n_m_per_rad=1.92",
        "law.step_of_ideal_per_ms=0.293",
        "law.limit_of_force_per_ms=0.9",
        "law.limit_of_penetration_per_ms=0.9",
        "law.energy_credit_j=1000",
        "law.filter.mass_kg_m2=7.5e-7",
        "law.filter.stiffness_n_m_per_rad=42",
        "law.filter.damping_n_m_s_per_rad=0.0457",
        "law.filter.ground_damping_n_m_s_per_rad=0.06",
        "wall.k_desired_n_m_per_rad=20",
        regulate,
    ]
    .map(str::to_owned);
    Scene::load("press-hold")
        .unwrap()
        .with_preset(Preset::Thesis)
        .unwrap()
        .with_overrides(&sets)
        .unwrap()
}

fn law(scene: &Scene) -> EnhancedSfa<f64> {
    match AnyLaw::<f64>::new(&scene.settings().unwrap()).unwrap() {
        AnyLaw::Enhanced(law, _) => law,
        _ => panic!("another law"),
    }
}

/// Penetration of the point of rest in the tests, rad.
const DEPTH: f64 = 0.01;

/// State of the control law at rest at the penetration [`DEPTH`].
fn resting(law: &EnhancedSfa<f64>) -> EnhancedState<f64> {
    // If the law regulates at the mass, its target stiffness is the force divided by the mass' position.
    let coupling = law.mass.stiffness.0;
    let force = match law.regulate {
        touchstone_control::Regulate::Hip => law.target.0 * DEPTH,
        _ => DEPTH / (1.0 / law.target.0 + 1.0 / coupling),
    };
    let mass = DEPTH - force / coupling;
    EnhancedState {
        contact: Phase::Augmenting,
        last: Position(DEPTH),
        force: Force(force),
        energy: Energy(1000.0),
        augmented: Augmented {
            mass: MassState {
                position: Position(mass),
                moved: Position(0.0),
            },
            offset: Position(force / law.soft.0 - mass),
            at_mass: Force(force),
        },
    }
}

/// State of the enhanced law as the matrices order it: position and displacement of the virtual mass, offset, last force,
/// penetration.
fn states(law: &EnhancedSfa<f64>, state: &EnhancedState<f64>) -> [f64; 5] {
    let held = &state.augmented;
    [
        held.mass.position.0,
        held.mass.moved.0,
        held.offset.0,
        match law.regulate {
            touchstone_control::Regulate::Hip => state.force.0,
            _ => held.at_mass.0,
        },
        state.last.0,
    ]
}

#[test]
fn the_enhanced_law_near_rest_is_its_matrix() {
    for regulate in [
        "law.regulate=hip",
        "law.regulate=mass",
        "law.regulate=mass-compensated",
    ] {
        let law = law(&scene(regulate));
        let linear = enhanced(&law, Offset::Updated).on_measured();
        let mut real = resting(&law);
        let rest = states(&law, &real);
        let rest_force = real.force.0;
        let mut predicted = DVector::zeros(5);
        let mut last = Position(DEPTH);
        let mut random = 1_u32;
        for _ in 0..400 {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let away = 1e-5 * (f64::from(random >> 8) / f64::from(1 << 23) - 1.0);
            let e = Position(DEPTH + away);
            let force = law.tick(&mut real, Sample::measured(e, last)).0;
            last = e;
            let expected = linear.advance(&mut predicted, away);
            assert!(
                (force - rest_force - expected).abs() < 1e-12,
                "{regulate}: {force} {expected}"
            );
            for ((now, rest), expected) in states(&law, &real)
                .into_iter()
                .zip(rest)
                .zip(predicted.iter())
            {
                assert!((now - rest - expected).abs() < 1e-12, "{regulate}");
            }
        }
        assert!(predicted.norm() > 1e-7, "nothing moved");
    }
}

/// Checks that the real control law on the real plant, with delay, moves as the loop's matrix predicts.
#[test]
fn the_whole_loop_is_its_matrix() {
    for delay_ticks in [0.0, 0.3, 1.0, 1.6] {
        let scene = scene("law.regulate=hip");
        let mut contact = Contact::of(&scene).unwrap();
        contact.clock.delay_s = delay_ticks * contact.clock.period_s;
        let law = law(&scene);
        let period = contact.clock.period_s;
        let (whole, fraction) = contact.clock.ticks();
        let device = contact.device;
        let before = HeldLinear::new(&device, &MEDIUM, fraction * period).unwrap();
        let after = HeldLinear::new(&device, &MEDIUM, (1.0 - fraction) * period).unwrap();
        let mut real = resting(&law);
        let force = real.force.0;
        let hand = DEPTH + force / MEDIUM.pad_stiffness;
        let rest = hand + force / MEDIUM.stiffness;
        let mut state = State::from_array([DEPTH + 1e-6, 0.0, hand, 0.0]);
        let mut queue: VecDeque<f64> = vec![-force; whole + 1].into();

        let plant = contact.plant(Some(&MEDIUM)).unwrap();
        let linear = enhanced(&law, Offset::Updated).on_measured();
        let matrix = plant.closed_by(&linear, 1.0);
        let mut predicted = DVector::zeros(matrix.nrows());
        predicted[0] = 1e-6;
        let mut last = Position(DEPTH);
        for tick in 0..300 {
            let e = Position(state.to_array()[0]);
            let command = -law.tick(&mut real, Sample::measured(e, last)).0;
            last = e;
            queue.push_back(command);
            let old = queue.pop_front().unwrap();
            before.step(&mut state, old, rest);
            after.step(&mut state, *queue.front().unwrap(), rest);
            predicted = &matrix * predicted;
            let now = state.to_array();
            for (index, rest) in [DEPTH, 0.0, hand, 0.0].into_iter().enumerate() {
                // The numbers for velocities are a thousand times those for positions, and so are their errors.
                let scale = if index % 2 == 0 { 1.0 } else { 1000.0 };
                assert!(
                    (now[index] - rest - predicted[index]).abs() < 2e-13 * scale,
                    "delay {delay_ticks}, tick {tick}, state {index}: {:e} {:e}",
                    now[index] - rest,
                    predicted[index]
                );
            }
        }
    }
}

#[test]
fn the_critical_stiffness_is_that_of_the_plants_own_golden_values() {
    use touchstone_world::plant::{Device, critical_stiffness};
    let device = Device {
        inertia: 1e-4,
        damping: 4e-4,
        friction: None,
    };
    for (hand, delay_s) in [
        (None, 0.0),
        (Some(MEDIUM), 0.0),
        (Some(MEDIUM), 0.7e-3),
        (Some(MEDIUM), 2e-3),
    ] {
        let critical = critical_stiffness(&device, hand.as_ref(), 1000.0, delay_s).unwrap();
        let mechanics = Mechanics {
            device,
            hand,
            current_loop_hz: None,
        };
        let clock = Clock {
            period_s: 1e-3,
            delay_s,
        };
        let plant = sampled(&mechanics, clock).unwrap();
        let radius = |stiffness: f64| {
            let law = LinearLaw::spring(stiffness, 0.0).on_measured();
            state_space::Mode::dominant(&plant.closed_by(&law, 1.0)).radius
        };
        assert!(radius(critical * 0.9999) < 1.0, "{delay_s}");
        assert!(radius(critical * 1.0001) > 1.0, "{delay_s}");
    }
}

#[test]
fn a_fast_current_loop_changes_little_and_a_slow_one_much() {
    let scene = scene("law.regulate=hip");
    let radius = |bandwidth| {
        let mut contact = Contact::of(&scene).unwrap();
        contact.current_loop_hz = bandwidth;
        contact.radius(Some(&MEDIUM))
    };
    let ideal = radius(None);
    assert!((radius(Some(1e5)) - ideal).abs() < 1e-3, "{ideal}");
    assert!(radius(Some(5.0)) > 1.0);
}

/// Checks that law and estimator, joined to one linear system, give the same forces as the controller.
#[test]
fn the_estimators_composition_does_what_the_controller_does() {
    let (k, damping) = (20.0, 0.02);
    for delay_s in [0.0, 0.4e-3, 1e-3, 1.52e-3, 2e-3] {
        let scene = Scene::load("press-hold")
            .unwrap()
            .with_overrides(&[
                "law.kind=spring-damper".to_owned(),
                format!("law.virtual_damping_n_m_s_per_rad={damping}"),
                format!("wall.k_desired_n_m_per_rad={k}"),
                format!("law.estimator.delay_s={delay_s}"),
                "law.impact.share_of_momentum=0".to_owned(),
                "law.guard.on=false".to_owned(),
            ])
            .unwrap();
        let estimator = Estimator::of(&scene).unwrap().expect("estimated states");
        let composed = LinearLaw::spring(k, damping / 1e-3).on_estimated(&estimator);
        let mut state = DVector::zeros(composed.order());
        let mut wall = Controller::<f64>::new(&scene.settings().unwrap()).unwrap();
        for tick in 0..200 {
            // Deep enough inside that the law never leaves the wall; both systems start from the same rest.
            let y = 1e-3 * (0.05 * f64::from(tick)).sin()
                + 1e-4 * f64::from(tick % 3)
                + 1e-4 * f64::from(tick);
            let running = wall.tick(Position(y)).0;
            let composed = composed.advance(&mut state, y);
            if tick == 0 {
                // The controller starts at its first measurement, the linear system at zero, where this motion begins.
                assert_eq!(y, 0.0);
            }
            assert!(running > 0.0 || tick == 0, "{tick}: let go at {y}");
            assert!(
                (running - composed).abs() < 1e-9 * (1.0 + running.abs()),
                "delay {delay_s}, {tick}: {running} {composed}"
            );
        }
    }
}

#[test]
fn the_estimator_holds_what_differences_do_not() {
    // A tick of delay at 20 times the critical stiffness: simulated runs hold with the estimator, but not with a damper on
    // differences.
    let scene = Scene::load("press-hold")
        .unwrap()
        .with_overrides(&[
            "law.kind=spring-damper".to_owned(),
            "law.virtual_damping_n_m_s_per_rad=0.0235".to_owned(),
            "wall.k_desired_n_m_per_rad=20".to_owned(),
            "timing.computational_delay_s=1e-3".to_owned(),
            "law.estimator.bandwidth_hz=69".to_owned(),
            "law.estimator.inertia_kg_m2=8e-5".to_owned(),
            "law.estimator.delay_s=6.4e-4".to_owned(),
        ])
        .unwrap();
    let mut contact = Contact::of(&scene).unwrap();
    let measured = Contact {
        estimator: None,
        ..contact.clone()
    };
    for (_, hand) in hands::GRIPS {
        assert!(measured.radius(Some(&hand)) > 1.0);
    }
    // One value changes at a time; the estimator assumes 0.64 ticks of delay and an inertia of 8e-5 kg·m² throughout.
    for (_, hand) in hands::GRIPS {
        for delay_s in [0.0, 1e-4, 5e-4, 1e-3] {
            contact.clock.delay_s = delay_s;
            let radius = contact.radius(Some(&hand));
            assert!(radius < 1.0, "delay {delay_s}: {radius}");
        }
        contact.clock.delay_s = 0.0;
        for inertia in [0.5, 2.0] {
            let radius = contact.with_inertia(inertia).radius(Some(&hand));
            assert!(radius < 1.0, "inertia {inertia}: {radius}");
        }
    }
}

#[test]
fn a_sample_of_random_devices_is_never_called_stable_wrongly() {
    for &states in StatesKind::ALL {
        let mut tally = campaign::Tally::default();
        for index in 0..SAMPLE {
            tally.add(&campaign::row(SEED, index, states).unwrap());
        }
        assert!(tally.wrong().is_empty(), "seed {SEED}\n{tally}");
        assert!(tally.stable() >= SAMPLE as u32 / 8, "seed {SEED}\n{tally}");
    }
}

/// Checks a law whose offset decays slowly: every touch comes to rest, a slow press does not, and the certificate simulates the
/// press.
#[test]
fn an_offset_that_dies_out_slowly_is_asked_for_by_presses() {
    let mut scene = campaign::scene(61, 1121, StatesKind::Measured);
    // The fractions per millisecond are multiplied, so that they apply per tick. At this rate the offset is then slow.
    let ticks_per_ms = 1e-3 * f64::from(scene.timing.rate_hz);
    for share in [
        &mut scene.law.step_of_ideal_per_ms,
        &mut scene.law.limit_of_penetration_per_ms,
        &mut scene.law.limit_of_force_per_ms,
    ] {
        *share *= ticks_per_ms;
    }
    let options = CertifyOptions {
        family: Family::Own,
        margins: false,
        ..CertifyOptions::default()
    };
    let own = certify(&scene, &options).unwrap().hands.remove(0);
    let (touches, presses) = (own.ends.unwrap(), own.presses.unwrap());
    assert!(
        touches[1] <= judge::RESTS && presses[1] > judge::RESTS,
        "{own:?}"
    );
    assert_eq!(own.verdict, Verdict::Undecided);
}

#[test]
fn what_is_played_settles_what_the_matrices_left_open() {
    let scene = Scene::load("press-hold").unwrap();
    let own = certify(&scene, &CertifyOptions::default())
        .unwrap()
        .hands
        .remove(0);
    let said = |verdict, stirred_by_ramp, touches, presses| {
        let mut report = own.clone();
        (report.verdict, report.stirred_by_ramp) = (verdict, stirred_by_ramp);
        (report.loan_used, report.decay_per_s) = (None, 0.5);
        judge::settle(&mut report, touches, presses);
        report.verdict
    };
    use Verdict::{Stable, Undecided, Unstable};
    assert_eq!(said(Undecided, false, [0.0, 0.4], None), Stable);
    assert_eq!(said(Undecided, false, [0.0, 0.6], None), Undecided);
    assert_eq!(said(Stable, false, [0.0, 0.6], None), Stable);
    assert_eq!(said(Stable, false, [0.0, 0.8], None), Undecided);
    assert_eq!(said(Stable, false, [1.6, 1.8], None), Unstable);
    // A slow offset: touches alone are not enough for "stable", and presses may overturn it.
    assert_eq!(said(Undecided, true, [0.0, 0.1], None), Undecided);
    assert_eq!(said(Undecided, true, [0.0, 0.1], Some([0.0, 0.1])), Stable);
    assert_eq!(
        said(Undecided, true, [0.0, 0.1], Some([0.0, 0.6])),
        Undecided
    );
    assert_eq!(
        said(Undecided, true, [0.0, 0.1], Some([0.0, f64::INFINITY])),
        Undecided
    );
    // A motion that grows without dry friction is not called stable because of a few presses.
    let mut grows = own.clone();
    (grows.verdict, grows.stirred_by_ramp, grows.decay_per_s) = (Undecided, true, -0.3);
    judge::settle(&mut grows, [0.0, 0.1], Some([0.0, 0.1]));
    assert_eq!(grows.verdict, Undecided);
}

#[test]
fn every_draw_of_a_campaign_is_a_wall_that_the_law_takes() {
    // Some walls of seed 41 are so soft that a tenth of their stiffness is below the least k_v of the settings.
    for (seed, index) in [SEED, 41]
        .into_iter()
        .flat_map(|seed| (0..2001).map(move |index| (seed, index)))
    {
        for &states in StatesKind::ALL {
            let scene = campaign::scene(seed, index, states);
            if let Err(error) = contact::Contact::of(&scene) {
                panic!("seed {seed}, number {index}: {error}");
            }
        }
    }
}

/// Seed of the validation campaign's random scenes.
const SEED: u64 = 1;
/// Number of simulated runs in the test; they take some seconds.
const SAMPLE: u64 = 48;
