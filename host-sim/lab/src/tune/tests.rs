//! Tests that the search finds a known optimum, gives the same result every time, and writes the settings that it evaluated.

use super::campaign::{Budget, Class, row, scene};
use super::cost::{Cost, Judgement};
use super::diagnosis::{FailureCause, of_row};
use super::parameters::{at, axes};
use super::search::{Until, minimise};
use super::{Effort, TuneOptions, pareto, settings, tune};
use crate::scorecard::reference::Reference;
use crate::scorecard::rivals::{RIVALS, Rival};
use crate::scorecard::{Entry, with_reference};
use touchstone_sim::scene::{Encoder, Scene, SensorNoise};

fn knob(k_desired: f64) -> Scene {
    let mut scene = Scene::load("thesis-knob").expect("a shipped scene");
    scene.wall.k_desired_n_m_per_rad = k_desired;
    scene
}

#[test]
fn a_bowl_has_a_bottom_and_every_seed_its_own_way_there() {
    let bowl = |x: &[f64]| Cost {
        value: (x[0] - 1.0).powi(2) + 10.0 * (x[1] + 2.0).powi(2),
        worst: 0.0,
    };
    let until = |evaluations, seed| Until {
        evaluations,
        worst: -1.0,
        seed,
    };
    let find = |seed| {
        minimise(
            &[vec![0.0, 0.0], vec![5.0, 5.0]],
            &until(600, seed),
            bowl,
            |_| (),
        )
    };
    let found = find(1);
    assert!(found.cost.value < 1e-6, "{found:?}");
    assert!(found.evaluations <= 600);
    assert_eq!(found.point, find(1).point);
    assert_ne!(found.point, find(2).point);
    // Without a parameter there is nothing to search.
    let none = minimise(
        &[Vec::new()],
        &until(100, 1),
        |_| Cost {
            value: 3.0,
            worst: 3.0,
        },
        |_| (),
    );
    assert_eq!((none.cost.value, none.evaluations), (3.0, 1));
}

#[test]
fn a_quick_search_leaves_no_device_out_where_few_are_asked_for() {
    // At 50 times the critical stiffness three devices count, of which the one with half a tick of delay decides. The nominal
    // device with noise is one more.
    for (k_desired, devices) in [(5.0, 6.0), (20.0, 6.0), (50.0, 4.0)] {
        let scene = knob(k_desired);
        let judgement = Judgement::new(&scene, Reference::none(), true);
        let one = judgement.programme().seconds(&scene) * f64::from(scene.timing.rate_hz) * 3.0;
        let looked = judgement.ticks(&scene) / one;
        assert!((looked - devices).abs() < 1e-9, "{k_desired}: {looked}");
    }
}

#[test]
fn every_parameter_starts_within_its_bounds_and_is_where_it_says() {
    for rival in &RIVALS {
        for k_desired in [0.5, 5.0, 50.0] {
            let scene = knob(k_desired);
            let axes = axes(rival, &scene);
            let point = vec![0.0; axes.len()];
            let started = at(rival, &scene, &axes, &point);
            let json = serde_json::to_value(&started).expect("numbers");
            for axis in &axes {
                assert!(axis.least > 0.0 && axis.least <= axis.start && axis.start <= axis.most);
                let place = format!("/{}", axis.parameter.path.replace('.', "/"));
                let value = json.pointer(&place).and_then(|value| value.as_f64());
                let value = value.unwrap_or_else(|| panic!("{}", axis.parameter.path));
                assert!(
                    (value / axis.start - 1.0).abs() < 1e-3,
                    "{}",
                    axis.parameter.path
                );
            }
            started.settings().expect("the law takes it");
        }
    }
}

#[test]
fn tuning_makes_a_wall_that_was_lost_and_writes_what_it_judged() {
    let scene = knob(5.0);
    let rival = Rival::named("spring-damper-estimated").expect("a law");
    let options = TuneOptions {
        seed: 3,
        effort: Effort::Ticks(3e6),
        ripple_n_m: Some(2e-3),
    };
    let mut last = (0, 1);
    let tuned = tune(&scene, rival, &options, |done, all| last = (done, all)).expect("runs");
    assert!(last.0 > 0 && last.0 <= last.1, "{last:?}");
    assert!(tuned.worst < 1.0, "{}", tuned.worst);
    // The same seed gives the same settings.
    let again = tune(&scene, rival, &options, |_, _| ()).expect("runs");
    assert_eq!(tuned.parameters, again.parameters);
    // The settings in the file are those that were judged.
    let folder = std::env::temp_dir().join(format!("touchstone-tune-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let file = folder.join("settings.toml");
    std::fs::write(&file, settings::toml(&tuned)).expect("a file");
    let read = scene.with_settings(&file).expect("its own file");
    std::fs::remove_dir_all(&folder).expect("gone");
    assert_eq!(
        Scene {
            origin: tuned.scene.origin.clone(),
            ..read
        },
        Scene {
            operator: scene.operator.clone(),
            ..tuned.scene.clone()
        }
    );
    let judgement = Judgement::new(&tuned.scene, tuned.reference, true);
    assert_eq!(judgement.cost(&tuned.scene).worst, tuned.worst);
}

#[test]
fn of_the_best_points_none_is_better_than_another() {
    let scene = knob(5.0);
    let rival = Rival::named("spring-damper-estimated").expect("a law");
    let axes = axes(rival, &scene);
    let tuned = super::Tuned {
        rival,
        scene: at(rival, &scene, &axes, &[-0.29, 0.02, -0.47, 0.03]),
        parameters: Vec::new(),
        worst: 0.0,
        evaluations: 0,
        reference: Reference::none(),
        seed: 0,
    };
    let points = pareto::points(&tuned, true, || ());
    let best: Vec<_> = points.iter().filter(|point| point.best).collect();
    assert!(!best.is_empty());
    for one in &best {
        for other in &best {
            let better = one.k_desired > other.k_desired
                && one.ripple_rms_n_m < other.ripple_rms_n_m
                && one.delay_margin_ticks > other.delay_margin_ticks;
            assert!(!better, "{one:?} {other:?}");
        }
        // A device with one tick of delay is among those on which the wall held.
        assert!(one.delay_margin_ticks >= 0.9, "{one:?}");
    }
    let drawn = touchstone_report::standalone("x", &[pareto::figure(&points)]);
    assert!(drawn.starts_with("<svg ") && !drawn.contains("NaN"));
}

#[test]
fn ten_random_devices_can_be_resolved_and_most_of_them_rest() {
    let rival = Rival::named("spring-damper-estimated").expect("a law");
    let mut rest = 0;
    for number in 0..10 {
        let class = Class::ALL[number as usize % 3];
        let device = scene(1, class, number);
        assert_eq!(device, scene(1, class, number), "a number has one device");
        let budget = Budget {
            first: 1e5,
            second: 0.0,
            for_all_measures: false,
        };
        let row = row(1, class, number, rival, budget).expect("runs");
        // Every failure has a cause, and a wall that holds has none.
        assert_eq!(row.rests, row.rest_cause.is_none(), "{row:?}");
        assert_eq!(row.moves, row.motion_cause.is_none(), "{row:?}");
        println!("{row:?}");
        rest += u32::from(row.rests);
    }
    assert!(rest >= 6, "{rest} of 10 rest");
}

#[test]
fn what_is_tuned_is_never_worse_than_what_was_there() {
    let rival = Rival::named("enhanced").expect("a law");
    // A search with almost no budget, whose start points are for another device.
    for (k_desired, inertia, noise_rad) in [
        (5.0, 1.0, None),
        (5.0, 1.6, None),
        (14.0, 1.0, None),
        (5.0, 1.0, Some(5.2e-4)),
    ] {
        let mut scene = knob(k_desired);
        scene.device.inertia_kg_m2 *= inertia;
        scene.sensor.noise = noise_rad.map(|rms_rad| SensorNoise { rms_rad });
        let options = TuneOptions {
            seed: 1,
            effort: Effort::Ticks(1.0),
            ripple_n_m: None,
        };
        let tuned = tune(&scene, rival, &options, |_, _| ()).expect("runs");
        let whole = Judgement::new(&scene, tuned.reference, false);
        let (found, own) = (whole.cost(&tuned.scene), whole.cost(&scene));
        assert!(
            found.value <= own.value,
            "{k_desired} {inertia}: {found:?} {own:?}"
        );
    }
}

#[test]
fn a_noise_of_zero_is_not_taken_for_the_usual_one() {
    let mut scene = knob(5.0);
    let cost = |scene: &Scene| {
        let judgement = Judgement::new(scene, Reference::of(scene).expect("runs"), true);
        judgement.cost(scene).value
    };
    let usual = cost(&scene);
    scene.sensor.noise = Some(SensorNoise { rms_rad: 0.0 });
    assert!(cost(&scene) < usual);
}

#[test]
fn a_wall_that_fails_says_why() {
    let fails = |scene: &Scene| {
        let rival = Rival::named("spring-damper-estimated").expect("a law");
        let reference = Reference::none();
        let entry = Entry {
            rival,
            scene: scene.clone(),
            tuned: true,
        };
        let card = with_reference(scene, &[entry], reference, |_| ());
        of_row(scene, &card.rows[0], &reference)
    };
    let rival = Rival::named("spring-damper-estimated").expect("a law");
    let scene = knob(5.0);
    let good = at(
        rival,
        &scene,
        &axes(rival, &scene),
        &[-0.29, 0.02, -0.47, 0.03],
    );
    assert_eq!(fails(&good), None);
    // A guard without energy to give reduces every force.
    let mut empty = good.clone();
    empty.law.guard.capacity_j = 1e-5;
    assert_eq!(fails(&empty), Some(FailureCause::Guard));
    let mut refused = good.clone();
    refused.law.guard.delay_s = 1.0;
    assert_eq!(fails(&refused), Some(FailureCause::Refused));
    let mut noisy = good.clone();
    noisy.sensor.noise = Some(SensorNoise { rms_rad: 3e-3 });
    assert_eq!(fails(&noisy), Some(FailureCause::Noise));
    // With these counts a press of 0.1 N·m is nine counts deep at 5 N·m/rad.
    let mut coarse = good.clone();
    coarse.encoder = Some(Encoder {
        counts_per_rev: 2830.0,
    });
    assert_eq!(fails(&coarse), Some(FailureCause::Counts));
    let mut undamped = good;
    undamped.law.virtual_damping_n_m_s_per_rad = 0.0;
    assert_eq!(fails(&undamped), Some(FailureCause::UnstableLoop));
}
