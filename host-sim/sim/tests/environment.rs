//! Tests of further walls, end stops and detents in whole simulations.

use touchstone_sim::run::record::Trace;
use touchstone_sim::run::{self, Recorder, Tick};
use touchstone_sim::scene::{Preset, Scene};

fn with(scene: &Scene, sets: &[&str]) -> Scene {
    scene.with_overrides(sets).unwrap()
}

/// Scene of a knob that moves freely between two walls, without a hand, from an initial speed of 5 rad/s.
fn thrown(sets: &[&str]) -> Scene {
    let scene = Scene::load("free-release").unwrap();
    with(
        &scene,
        &[
            &[
                "wall.surface_rad=0.3",
                "environment.wall2.at_rad=-0.3",
                "device.initial_angle_rad=0",
                "device.initial_velocity_rad_per_s=5",
                "encoder.counts_per_rev=40000",
                "timing.duration_s=2",
            ],
            sets,
        ]
        .concat(),
    )
}

fn trace(scene: &Scene) -> Trace {
    run::run(scene, true).unwrap().trace.unwrap()
}

fn bits(scene: &Scene) -> Vec<u64> {
    let trace = trace(scene);
    let columns = [trace.angle_rad, trace.force_n_m, trace.energy_true_j];
    columns.concat().into_iter().map(f64::to_bits).collect()
}

#[test]
fn a_knob_thrown_either_way_does_the_mirror_image_to_the_bit() {
    for number in ["fixed32", "fixed16", "f64"] {
        for law in ["enhanced-sfa", "spring-damper", "tdpa"] {
            for states in ["measured", "estimated"] {
                let sets = [
                    format!("law.number={number}"),
                    format!("law.kind={law}"),
                    format!("law.states={states}"),
                    "environment.detents.per_rev=30".to_owned(),
                    "environment.detents.strength_n_m=0.002".to_owned(),
                    "law.force_limit_n_m=0.4".to_owned(),
                ];
                let sets: Vec<&str> = sets.iter().map(String::as_str).collect();
                let there = trace(&thrown(&sets));
                let back = [&sets[..], &["device.initial_velocity_rad_per_s=-5"]].concat();
                let back = trace(&thrown(&back));
                let mirrored = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| *a == -b);
                assert!(mirrored(&there.angle_rad, &back.angle_rad), "{sets:?}");
                assert!(mirrored(&there.force_n_m, &back.force_n_m), "{sets:?}");
                // The knob reaches the wall at 0.3 rad and moves back.
                let reached = |most: f64| there.angle_rad.iter().any(|x| *x > most);
                assert!(reached(0.3) && there.angle_rad.iter().any(|x| *x < 0.25));
            }
        }
    }
}

#[test]
fn an_environment_with_nothing_in_it_is_the_wall() {
    for name in ["press-hold", "thesis-knob"] {
        let scene = Scene::load(name).unwrap();
        let plain = bits(&scene);
        for set in [
            "environment.first_wall=true",
            "environment.detents.strength_n_m=0",
        ] {
            assert!(plain == bits(&with(&scene, &[set])), "{name} {set}");
        }
        // A wall that the knob never reaches changes nothing.
        let far = ["environment.wall2.at_rad=-2"];
        assert!(plain == bits(&with(&scene, &far)), "{name}");
        // Without the main wall the knob passes the position of its surface.
        let open = with(&scene, &["environment.first_wall=false"]);
        assert!(trace(&open).force_n_m.iter().all(|force| *force == 0.0));
    }
}

#[test]
fn each_of_several_walls_is_the_wall_of_its_own_scene() {
    // `wall2` replaces the main wall at 0.5 rad; a third wall and two end stops are added, which the press does not reach.
    let scene = Scene::load("press-hold").unwrap();
    let alone = bits(&scene);
    let among = with(
        &scene,
        &[
            "environment.first_wall=false",
            "environment.wall2.at_rad=0.5",
            "environment.wall2.solid=above",
            "environment.wall3.at_rad=-0.4",
            "environment.endstops.upper_rad=2",
            "environment.endstops.lower_rad=-2",
        ],
    );
    assert_eq!(scene.wall.surface_rad, 0.5);
    assert!(alone == bits(&among));
    // A further wall without a stiffness has that of the first wall, from which the hand's rest point is computed too.
    let two = "wall.k_desired_n_m_per_rad=2";
    let soft = bits(&with(&scene, &[two]));
    assert!(soft == bits(&with(&among, &[two])) && soft != alone);
    let own = |k: &str| format!("environment.wall2.stiffness_n_m_per_rad={k}");
    assert!(soft == bits(&with(&among, &[two, &own("2")])));
    assert!(soft != bits(&with(&among, &[two, &own("3")])));
}

/// Scene of a knob without a hand, with some damping and 20 detents per turn.
fn in_a_detent(sets: &[&str]) -> Scene {
    let scene = Scene::load("free-release").unwrap();
    with(
        &scene,
        &[
            &[
                "environment.first_wall=false",
                "environment.detents.per_rev=20",
                "environment.detents.strength_n_m=0.01",
                "device.initial_velocity_rad_per_s=0",
                "device.damping_n_m_s_per_rad=1e-2",
                "encoder.counts_per_rev=40000",
                "timing.duration_s=3",
            ],
            sets,
        ]
        .concat(),
    )
}

#[test]
fn a_detent_holds_what_is_weaker_and_lets_go_of_what_is_stronger() {
    let pitch = std::f64::consts::TAU / 20.0;
    let count = std::f64::consts::TAU / 40_000.0;
    let end = |sets: &[&str]| *trace(&in_a_detent(sets)).angle_rad.last().unwrap();
    // A knob released near the ridge between two detents comes to rest in the detent on its side.
    for (from, rest) in [
        ("0.15", 0.0),
        ("-0.15", 0.0),
        ("0.17", pitch),
        ("-0.17", -pitch),
    ] {
        let at = end(&[&format!("device.initial_angle_rad={from}")]);
        assert!((at - rest).abs() < 2.0 * count, "{from}: {at} for {rest}");
    }
    // A steady torque below the detent's strength is held, at the angle that the triangle gives. A larger torque turns the knob
    // over the ridge. An imbalance with a suitable phase gives such a torque.
    let pushed = |torque: f64| {
        let imbalance = format!("device.imbalance.torque_n_m={torque}");
        let phase = format!(
            "device.imbalance.phase_rad={}",
            -std::f64::consts::FRAC_PI_2
        );
        end(&["device.initial_angle_rad=0", &imbalance, &phase])
    };
    let held = pushed(0.008);
    let expected = 0.8 * 0.25 * pitch;
    assert!(
        (held - expected).abs() < 4.0 * count,
        "{held} for {expected}"
    );
    assert!(pushed(0.011) > 0.6 * pitch);
}

/// Energy sums of a simulation, J: net and absolute energy that the environment absorbed, and losses of the device. Also the first
/// and last squared speed, (rad/s)².
#[derive(Default)]
struct Books {
    absorbed: f64,
    lost: f64,
    thrown: f64,
    first: Option<f64>,
    last: f64,
}

impl Recorder for Books {
    fn record(&mut self, tick: &Tick) {
        self.absorbed += tick.absorbed_j;
        self.thrown += tick.absorbed_j.abs();
        self.lost += tick.device_loss_j;
        self.first.get_or_insert(tick.velocity_rad_per_s.powi(2));
        self.last = tick.velocity_after_rad_per_s.powi(2);
    }
}

#[test]
fn the_books_of_walls_and_detents_close() {
    for more in [
        &["environment.detents.per_rev=24"][..],
        &[
            "environment.wall3.at_rad=0.1",
            "environment.wall3.solid=above",
        ],
        &[
            "environment.endstops.lower_rad=-0.2",
            "environment.endstops.upper_rad=0.2",
        ],
    ] {
        let scene = thrown(more);
        let books = run::watch(&scene, Books::default()).unwrap();
        let half = 0.5 * scene.device.inertia_kg_m2;
        let motion = half * (books.last - books.first.unwrap());
        let open = motion + books.absorbed + books.lost;
        assert!(books.thrown > 1e-4, "{more:?}");
        assert!(
            open.abs() < 1e-12 * (books.thrown + books.lost),
            "{more:?}: {open:e}"
        );
    }
}

#[test]
fn a_knob_between_two_walls_comes_to_rest_with_the_shipped_law() {
    for number in ["fixed32", "f64"] {
        let scene = with(
            &thrown(&[]),
            &[&format!("law.number={number}"), "timing.duration_s=6"],
        );
        let run = run::run(&scene, true).unwrap();
        let trace = run.trace.unwrap();
        let last = &trace.angle_rad[5_500..];
        let spread = last
            .iter()
            .fold(0.0_f64, |worst, x| worst.max((x - last[0]).abs()));
        assert!(spread < 1e-3, "{number}: {spread}");
        assert!(trace.angle_rad.iter().all(|x| x.abs() < 0.5));
    }
}

#[test]
fn what_cannot_be_is_refused_at_its_place() {
    let scene = Scene::load("press-hold")
        .and_then(|scene| scene.with_preset(Preset::Thesis))
        .unwrap();
    let said = |sets: &[&str]| {
        let scene = scene.with_overrides(sets);
        let error = scene.and_then(|scene| run::run(&scene, false).map(drop));
        error.expect_err("refused").to_string()
    };
    for (sets, words) in [
        (
            &["environment.endstops.upper_rad=-1"][..],
            "must be above lower_rad",
        ),
        (
            &["environment.detents.strength_n_m=0.6"],
            "law.force_limit_n_m",
        ),
        (&["environment.detents.per_rev=6284"], "between 0 and 6283"),
        (
            &[
                "environment.detents.per_rev=0",
                "environment.detents.pitch_rad=0.0009",
            ],
            "between 0.001 and 6.283",
        ),
        (&["environment.wall2.solid=left"], "above"),
        (&["environment.wall5.at_rad=1"], "wall"),
        (
            &[
                "law.number=fixed16",
                "environment.wall2.stiffness_n_m_per_rad=600",
            ],
            "environment.wall2.stiffness_n_m_per_rad",
        ),
    ] {
        let said = said(sets);
        assert!(
            said.contains(words) && !said.contains('\n'),
            "{sets:?}: {said}"
        );
    }
}
