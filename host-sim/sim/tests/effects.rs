//! Tests of every simulated effect in a whole simulation: the result at typical magnitude and at amplitude zero, figures of the
//! effect, and the random seed.

use touchstone_sim::run::effects::{EFFECTS, Effect, exclude_each_other};
use touchstone_sim::run::live::Live;
use touchstone_sim::run::record::Trace;
use touchstone_sim::run::{self, Recorder, Tick};
use touchstone_sim::scene::{Preset, RestPath, Scene};

/// Scene of a hand that presses on a wall with a linear law, without sensor errors, friction or limits.
fn ideal() -> Scene {
    Scene::load("press-hold")
        .and_then(|scene| scene.with_preset(Preset::Thesis))
        .and_then(|scene| {
            scene.with_overrides(&[
                "law.kind=spring",
                "wall.k_desired_n_m_per_rad=0.5",
                "law.number=f64",
            ])
        })
        .unwrap()
}

fn trace(scene: &Scene) -> Trace {
    run::run(scene, true).unwrap().trace.unwrap()
}

fn bits(scene: &Scene) -> Vec<u64> {
    let trace = trace(scene);
    [
        trace.angle_rad,
        trace.angle_measured_rad,
        trace.hand_rad,
        trace.force_n_m,
        trace.energy_true_j,
        trace.energy_device_loss_j,
    ]
    .concat()
    .into_iter()
    .map(f64::to_bits)
    .collect()
}

fn with(scene: &Scene, sets: &[&str]) -> Scene {
    scene.with_overrides(sets).unwrap()
}

/// Makes the scene without the effect. If the effect is the hand itself, the knob starts with a speed in place of being moved.
fn without(effect: &Effect) -> Scene {
    let scene = ideal();
    match effect.name {
        // A knob without a hand that starts with a speed.
        "hand" => with(
            &scene.with(effect.remove).unwrap(),
            &["device.initial_velocity_rad_per_s=0.5"],
        ),
        _ => scene,
    }
}

#[test]
fn every_effect_does_something_and_can_be_taken_away_again() {
    for effect in EFFECTS {
        let plain = without(effect);
        assert!(!(effect.is_named)(&plain), "{}", effect.name);
        let added = plain.with(effect.add).unwrap();
        assert!((effect.is_named)(&added), "{}", effect.name);
        // A torque limit of five times the press has no effect, and neither have walls that the knob never reaches.
        let idle = ["torque-limit", "second-wall", "endstops"].contains(&effect.name);
        let changes = bits(&plain) != bits(&added);
        assert_eq!(changes, !idle, "{}", effect.name);
        let removed = added.with(effect.remove).unwrap();
        assert!(!(effect.is_named)(&removed), "{}", effect.name);
    }
    let low = with(&ideal(), &["device.torque_limit_n_m=0.05"]);
    assert_ne!(bits(&ideal()), bits(&low));
}

#[test]
fn an_effect_of_no_amplitude_is_its_absence_to_the_bit() {
    let plain = bits(&ideal());
    let silent: Vec<_> = EFFECTS
        .iter()
        .filter_map(|effect| Some((effect.name, effect.silence?)))
        .collect();
    assert!(silent.len() >= 11);
    for (name, silence) in silent {
        let scene = ideal().with(silence).unwrap();
        assert!(bits(&scene) == plain, "{name}");
    }
    // Checks the same for an effect that is a part of another effect.
    let sticky = with(&ideal(), &["device.friction.kinetic_n_m=1e-3"]);
    for set in [
        "device.friction.asymmetry_n_m=0",
        // A Stribeck velocity has no effect if static and kinetic friction are equal.
        "device.friction.stribeck_rad_per_s=0.1",
    ] {
        assert!(bits(&sticky) == bits(&with(&sticky, &[set])), "{set}");
    }
}

#[test]
fn what_has_no_amplitude_converges_to_its_absence() {
    let off = |scene: &Scene, sets: &[&str]| {
        let (a, b) = (trace(scene), trace(&with(scene, sets)));
        a.angle_rad
            .iter()
            .zip(&b.angle_rad)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max)
    };
    let smooth = ideal();
    let sticky = with(&smooth, &["device.friction.kinetic_n_m=1e-3"]);
    let pair = |scene: &Scene, near: &[&str], nearer: &[&str]| {
        let (far, close) = (off(scene, near), off(scene, nearer));
        println!("{near:?}: {far:.1e} {close:.1e}");
        assert!(close < 0.3 * far, "{near:?}: {far:e} {close:e}");
    };
    pair(
        &smooth,
        &["device.current_loop.bandwidth_hz=1e4"],
        &["device.current_loop.bandwidth_hz=1e5"],
    );
    let stiff = |stiffness: &str| format!("device.transmission.spring_n_m_per_rad={stiffness}");
    pair(&smooth, &[&stiff("1e3")], &[&stiff("1e4")]);
    // Very stiff bristles act like dry friction, within the accuracy of the substeps.
    let bristles = "device.friction.bristle_stiffness_n_m_per_rad";
    let (soft, hard) = (format!("{bristles}=1"), format!("{bristles}=1000"));
    pair(&sticky, &[&soft], &[&hard]);
}

#[test]
fn noise_has_the_variance_that_it_names_and_a_period_its_amplitude() {
    let errors = |set: &str| -> Vec<f64> {
        let trace = trace(&with(&ideal(), &[set, "timing.duration_s=20"]));
        trace
            .angle_measured_rad
            .iter()
            .zip(&trace.angle_rad)
            .map(|(told, is)| told - is)
            .collect()
    };
    let noise = errors("sensor.noise.rms_rad=1e-4");
    let n = noise.len() as f64;
    let variance = noise.iter().map(|e| e * e).sum::<f64>() / n;
    // Five standard deviations of a sample's variance.
    assert!(
        (variance / 1e-8 - 1.0).abs() < 5.0 * (2.0 / n).sqrt(),
        "{variance:e}"
    );
    let periodic = errors("sensor.periodic.amplitude_rad=1e-3");
    let trace = trace(&with(&ideal(), &["sensor.periodic.amplitude_rad=1e-3"]));
    for (error, angle) in periodic.iter().zip(&trace.angle_rad) {
        assert!((error - 1e-3 * angle.sin()).abs() < 1e-15);
    }
    // A second component of the periodic error with twice as many periods, alone and together with the first one.
    for first in [0.0, 1e-3] {
        let asked = [
            &*format!("sensor.periodic.amplitude_rad={first}"),
            "sensor.periodic.second_amplitude_rad=2e-3",
            "sensor.periodic.second_phase_rad=0.5",
        ];
        let scene = with(&ideal(), &asked);
        let trace = crate::trace(&scene);
        for (told, angle) in trace.angle_measured_rad.iter().zip(&trace.angle_rad) {
            let error = first * angle.sin() + 2e-3 * (2.0 * angle + 0.5).sin();
            assert!((told - angle - error).abs() < 1e-15);
        }
    }
}

/// Differences between the motor's torque and the commanded torque, N·m. Also counts the ticks in which the knob moved, and those
/// in which the control law then received the previous angle again.
#[derive(Default)]
struct Torques {
    off: Vec<f64>,
    moved: u32,
    kept: u32,
    last: Option<(f64, f64)>,
}

impl Recorder for Torques {
    fn record(&mut self, tick: &Tick) {
        self.off.push(tick.motor_force_n_m - tick.force_n_m);
        if let Some((angle, told)) = self.last
            && angle != tick.angle_rad
        {
            self.moved += 1;
            self.kept += u32::from(told == tick.told_rad);
        }
        self.last = Some((tick.angle_rad, tick.told_rad));
    }
}

#[test]
fn a_current_sensor_and_lost_ticks_do_what_they_name() {
    let scene = with(
        &ideal(),
        &[
            "device.current_sensor.noise_rms_n_m=3e-4",
            "device.current_sensor.step_n_m=1e-3",
            "timing.duration_s=20",
        ],
    );
    let found = run::watch(&scene, Torques::default()).unwrap();
    let n = found.off.len() as f64;
    let variance = found.off.iter().map(|e| e * e).sum::<f64>() / n;
    let expected = 9e-8 + 1e-6 / 12.0;
    assert!(
        (variance / expected - 1.0).abs() < 5.0 * (2.0 / n).sqrt(),
        "{variance:e} {expected:e}"
    );
    let scene = with(&ideal(), &["timing.lost_share=0.1", "timing.duration_s=20"]);
    let found = run::watch(&scene, Torques::default()).unwrap();
    let moved = f64::from(found.moved);
    let (share, spread) = (f64::from(found.kept) / moved, (0.09 / moved).sqrt());
    assert!(moved > 5000.0);
    assert!((share - 0.1).abs() < 5.0 * spread, "{share}");
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_others() {
    for set in [
        "sensor.noise.rms_rad=1e-4",
        "device.current_sensor.noise_rms_n_m=1e-4",
        "timing.jitter_s=1e-4",
        "timing.latency_spread_s=2e-4",
        "timing.lost_share=0.05",
    ] {
        let scene = with(&ideal(), &[set]);
        assert!(bits(&scene) == bits(&scene), "{set}");
        assert!(
            bits(&scene) == bits(&with(&scene, &["seed=1"])),
            "{set}: absent is 1"
        );
        assert!(bits(&scene) != bits(&with(&scene, &["seed=2"])), "{set}");
    }
    // Sources of noise are independent: if the second has amplitude zero, the first gives the same numbers as alone.
    let noisy = with(&ideal(), &["sensor.noise.rms_rad=1e-4"]);
    let both = with(
        &noisy,
        &[
            "device.current_sensor.noise_rms_n_m=1e-300",
            "device.current_sensor.step_n_m=0",
        ],
    );
    assert_eq!(
        trace(&noisy).angle_measured_rad,
        trace(&both).angle_measured_rad
    );
}

#[test]
fn late_commands_lie_between_the_least_and_the_greatest_delay() {
    // With almost no spread the delay is fixed to one of the 1,024 parts of a period. With a spread of half a period the delay
    // lies between two fixed delays.
    let first_force = |sets: &[&str]| {
        struct First(Option<f64>);
        impl Recorder for First {
            fn record(&mut self, tick: &Tick) {
                if tick.motor_force_n_m != 0.0 && self.0.is_none() {
                    self.0 = Some(tick.motor_force_n_m / tick.force_n_m);
                }
            }
        }
        run::watch(&with(&ideal(), sets), First(None))
            .unwrap()
            .0
            .unwrap()
    };
    // Fraction of the first tick in contact during which the command acted.
    let fixed = first_force(&["timing.computational_delay_s=2.5e-4"]);
    assert!((fixed - 0.75).abs() < 1e-12);
    let nearly = first_force(&[
        "timing.computational_delay_s=2.5e-4",
        "timing.latency_spread_s=1e-9",
        "timing.jitter_s=1e-9",
    ]);
    assert!((nearly - 0.75).abs() < 1e-12, "{nearly}");
    for seed in 1..20 {
        let seed = format!("seed={seed}");
        let spread = first_force(&[
            "timing.computational_delay_s=2.5e-4",
            "timing.latency_spread_s=5e-4",
            &seed,
        ]);
        assert!((0.25..=0.75).contains(&spread), "{spread}");
    }
    // Samples are late by up to a period. With jitter alone and no force, the displacement is that of the elapsed time.
    let free = Scene::load("free-release")
        .unwrap()
        .with_overrides(&[
            "law.kind=spring",
            "wall.surface_rad=1e3",
            "device.initial_angle_rad=0",
            "device.initial_velocity_rad_per_s=1",
            "device.damping_n_m_s_per_rad=0",
            "timing.jitter_s=1e-3",
            "timing.duration_s=1",
        ])
        .unwrap();
    let ways = trace(&free).angle_rad;
    assert!(
        ways.iter()
            .enumerate()
            .all(|(tick, x)| (-1e-12..=1.001e-3).contains(&(x - tick as f64 * 1e-3)))
    );
    assert!(ways.windows(2).any(|pair| pair[1] - pair[0] < 0.5e-3));
}

#[test]
fn a_hand_trembles_and_answers_late() {
    // Outside the wall only the hand moves the knob, so the motion has the frequency of the tremor.
    let still = [
        "operator.motion.kind=none",
        "operator.tremor.amplitude_rad=0.02",
        "operator.tremor.frequency_hz=5",
        "timing.duration_s=4",
    ];
    let angles = trace(&with(&ideal(), &still)).angle_rad;
    let settled = &angles[2000..];
    let mean = settled.iter().sum::<f64>() / settled.len() as f64;
    let rises = settled
        .windows(2)
        .filter(|pair| pair[0] < mean && pair[1] >= mean)
        .count();
    assert_eq!(rises, 10, "2 s of 5 Hz");
    // A reflex as stiff as the hand's spring halves the displacement under a steady push.
    let push = |sets: &[&str]| {
        let scene = with(
            &ideal(),
            &[
                &[
                    "operator.motion.kind=none",
                    "device.imbalance.torque_n_m=2e-3",
                    "device.imbalance.phase_rad=1.1207963267948966",
                    "timing.duration_s=8",
                ],
                sets,
            ]
            .concat(),
        );
        let rest = RestPath::from_scene(&scene).unwrap().rest_rad(0.0);
        trace(&scene).hand_rad.last().unwrap() - rest
    };
    let (alone, answered) = (
        push(&[]),
        push(&[
            "operator.reflex.muscle_stiffness_n_m_per_rad=0.0225",
            "operator.reflex.delay_s=0.02",
        ]),
    );
    println!("{alone} {answered}");
    assert!((answered / alone - 0.5).abs() < 0.02);
}

#[test]
fn every_pair_of_effects_runs_and_closes_its_books_live() {
    for (at, first) in EFFECTS.iter().enumerate() {
        for second in EFFECTS[at + 1..]
            .iter()
            .filter(|second| !exclude_each_other(first, second))
        {
            let scene = ideal()
                .with(first.add)
                .and_then(|scene| scene.with(second.add))
                .unwrap();
            let scene = with(&scene, &["timing.duration_s=2.3"]);
            let mut live = Live::new(&scene).unwrap();
            let motion = RestPath::from_scene(&scene).unwrap();
            for tick in 0..700 {
                let moment = live.tick(motion.rest_rad(f64::from(tick) * 1e-3));
                // While the hand presses, the energy that it has put in must stay finite and small.
                assert!(
                    moment.energies.hand_j().abs() < 0.1,
                    "{} {}",
                    first.name,
                    second.name
                );
            }
            assert!(live.angle_rad().is_finite());
        }
    }
}

#[test]
fn contradictions_are_refused_where_they_are_written() {
    let refusal = |sets: &[&str]| {
        let error = ideal()
            .with_overrides(sets)
            .and_then(|scene| run::run(&scene, false).map(drop));
        error.unwrap_err().to_string()
    };
    for (sets, part) in [
        (&["timing.jitter_s=2e-3"][..], "at most the period"),
        (
            &[
                "device.friction.kinetic_n_m=1e-3",
                "device.friction.asymmetry_n_m=2e-3",
            ],
            "leaves nothing of kinetic_n_m",
        ),
        (
            &[
                "device.friction.kinetic_n_m=0",
                "device.friction.bristle_stiffness_n_m_per_rad=10",
            ],
            "never let go",
        ),
        (
            &[
                "operator.motion.kind=none",
                "operator.grip=none",
                "operator.tremor.amplitude_rad=0.1",
            ],
            "no hand holds",
        ),
        (
            &[
                "device.cogging.torque_n_m=1e-3",
                "plant.integrator=implicit-euler",
            ],
            "only the exact integrator supports",
        ),
        (
            &[
                "device.friction.kinetic_n_m=1e-3",
                "device.friction.asymmetry_n_m=1e-4",
                "plant.integrator=implicit-euler",
            ],
            "only the exact integrator supports",
        ),
    ] {
        let message = refusal(sets);
        assert!(message.contains(part), "{sets:?}: {message}");
    }
}
