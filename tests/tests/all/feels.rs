//! Tests of the shipped haptic effects of a knob (detents, end stops and others) under every simulated grip, and of scene files
//! that extend another scene file.

use std::f64::consts::TAU;
use std::path::Path;

use touchstone_lab::scorecard::feel::feel_card;
use touchstone_sim::run::record::{Trace, Verdict};
use touchstone_sim::run::run;
use touchstone_sim::scene::{self, MotionSpec, Scene};

const GRIPS: [&str; 3] = ["light", "medium", "firm"];

fn feel(name: &str, sets: &[&str]) -> Scene {
    let scene = Scene::load(name).unwrap();
    scene.with_overrides(sets).unwrap()
}

fn traced(scene: &Scene) -> Trace {
    run(scene, true).unwrap().trace.unwrap()
}

/// Checks that every shipped haptic effect is quiet at rest, and stays within the energy guard's account.
#[test]
fn every_feel_is_quiet_under_every_grip() {
    for name in scene::feels() {
        for grip in GRIPS {
            let scene = feel(name, &[&format!("grip={grip}")]);
            let summary = run(&scene, false).unwrap().summary;
            let wanted = match name {
                "smooth" => Verdict::NoContact,
                _ => Verdict::Passive,
            };
            assert_eq!(summary.verdict, wanted, "{name} {grip}: {summary:?}");
            let count = TAU / scene.encoder.unwrap().counts_per_rev;
            let buzz = summary.limit_cycle_peak_to_peak.unwrap_or(0.0);
            assert!(
                buzz <= 2.0 * count,
                "{name} {grip}: {} counts",
                buzz / count
            );
            assert!(summary.guard_account_min_j >= Some(0.0), "{name} {grip}");
            assert_eq!(summary.guard_tripped_s, None, "{name} {grip}");
        }
    }
}

/// Checks that a hand that turns at 2 rad/s feels every haptic effect unreduced: the energy that sampling gives is then within the
/// power that refills the energy guard's account. If the knob is spun faster, clicks get softer.
#[test]
fn a_hand_that_turns_calmly_gets_all_of_a_feel() {
    for name in scene::feels() {
        for grip in GRIPS {
            let scene = feel(name, &[&format!("grip={grip}")]);
            let MotionSpec::Turn(turn) = &scene.operator.motion else {
                panic!("{name}: no turn")
            };
            // A movement from rest to rest is 15/8 times as fast in its middle as on average. Beyond an end it would push against
            // the motor's limit, and the hand gets no more back than the guard's account holds.
            let around = scene.environment.as_ref().unwrap();
            let end = around
                .endstops
                .as_ref()
                .map_or(f64::INFINITY, |ends| ends.upper_rad);
            let angle_rad = turn.angle_rad.min(end);
            let turn_s = angle_rad * 15.0 / 8.0 / 2.0;
            let slow = scene.with(|scene| {
                if let MotionSpec::Turn(turn) = &mut scene.operator.motion {
                    (turn.angle_rad, turn.turn_s) = (angle_rad, turn_s);
                }
                scene.timing.duration_s = 2.0 * turn_s + 3.0;
            });
            let summary = run(&slow.unwrap(), false).unwrap().summary;
            assert_eq!(summary.guard_limited_ticks, Some(0), "{name} {grip}");
        }
    }
}

/// Checks that a hand feels the detent torque that the scene file states, to within 5 %, and that the knob comes to rest in a
/// detent, as near its centre as dry friction and the hand's pull allow.
#[test]
fn detents_have_their_torque_and_hold() {
    for name in scene::feels() {
        for grip in GRIPS {
            let scene = feel(name, &[&format!("grip={grip}")]);
            let around = scene.environment.clone().unwrap();
            // If the scene also has a torque profile, the torque is not the detents' alone. Detents without torque do not hold.
            let felt = |strength_n_m| around.profile.is_none() && strength_n_m > 0.0;
            let Some(ring) = around.detents.filter(|ring| felt(ring.strength_n_m)) else {
                continue;
            };
            let trace = traced(&scene);
            let pitch = TAU / f64::from(ring.per_rev);
            let free = around.endstops.map(|ends| (ends.lower_rad, ends.upper_rad));
            // At an end stop the stop's wall pushes as well, beginning before its surface.
            let between = |angle: f64| {
                free.is_none_or(|(lower, upper)| lower + 0.1 < angle && angle < upper - 0.1)
            };
            let ticks = trace.angle_rad.iter().zip(&trace.force_n_m);
            let most = ticks
                .filter(|(angle, _)| between(**angle))
                .fold(0.0_f64, |most, (_, force)| most.max(force.abs()));
            let share = most / ring.strength_n_m;
            // A light hand cannot leave the strongest detents.
            let crossed = trace.angle_rad.iter().any(|angle| *angle > pitch);
            assert!(
                share <= 1.05 && (share >= 0.95 || !crossed),
                "{name} {grip}: {share} of the torque"
            );
            assert!(
                crossed || grip == "light",
                "{name} {grip} stays where it is"
            );
            let last = *trace.angle_rad.last().unwrap();
            let beyond = (last / pitch - (last / pitch).round()) * pitch;
            // The slope of a triangle wave of amplitude A and pitch P is 4 A/P.
            let held =
                scene.device.friction.unwrap().kinetic_n_m / (4.0 * ring.strength_n_m / pitch);
            let hand = scene.operator.hand().unwrap().compliance_rad_per_n_m();
            let pulled = last / hand / (4.0 * ring.strength_n_m / pitch);
            assert!(
                beyond.abs() <= held + pulled.abs() + 1e-3,
                "{name} {grip}: {beyond} rad"
            );
        }
    }
}

/// Checks that a hand feels a drawn torque profile as it is drawn at every angle, to within 5 % of its strength and the strength of
/// detents beside it.
#[test]
fn a_profile_is_felt_as_it_is_drawn() {
    let mut felt = 0;
    for name in scene::feels() {
        for grip in GRIPS {
            let scene = feel(name, &[&format!("grip={grip}")]);
            let around = scene.environment.clone().unwrap();
            let Some(profile) = around.profile else {
                continue;
            };
            let trace = traced(&scene);
            let pitch = TAU / f64::from(profile.per_rev);
            let points = profile.shape.len();
            let drawn = |angle: f64| {
                let place = (angle - profile.start_rad).rem_euclid(pitch) / pitch * points as f64;
                let (before, way) = (place.floor() as usize % points, place.fract());
                let after = (before + 1) % points;
                profile.strength_n_m
                    * (profile.shape[before] * (1.0 - way) + profile.shape[after] * way)
            };
            let other = around.detents.map_or(0.0, |ring| ring.strength_n_m);
            let (lower, upper) = around.endstops.map_or((f64::MIN, f64::MAX), |ends| {
                (ends.lower_rad + 0.1, ends.upper_rad - 0.1)
            });
            for (angle, force) in trace.angle_rad.iter().zip(&trace.force_n_m) {
                if (lower..upper).contains(angle) {
                    let wrong = (-force - drawn(*angle)).abs();
                    assert!(
                        wrong <= 0.05 * profile.strength_n_m + other,
                        "{name} {grip}: {wrong} N·m wrong at {angle} rad"
                    );
                    felt += 1;
                }
            }
        }
    }
    assert!(felt > 12 * 1000, "{felt}");
}

/// Checks that a hand feels listed detents as they are listed, to within 5 % of the strongest, and that the knob passes all of
/// them.
#[test]
fn a_list_is_felt_as_it_is_listed() {
    for grip in ["medium", "firm"] {
        let scene = feel("selector", &[&format!("grip={grip}")]);
        let list = scene.environment.clone().unwrap().detent_list.unwrap();
        let most = list.strengths_n_m.iter().copied().fold(0.0, f64::max);
        let listed = |angle: f64| -> f64 {
            let detents = list.positions_rad.iter().zip(&list.strengths_n_m);
            let torques = detents
                .zip(&list.widths_rad)
                .map(|((at, strength), width)| {
                    let size = (angle - at) / (width / 4.0);
                    size.signum() * strength * size.abs().min(2.0 - size.abs()).max(0.0)
                });
            torques.sum()
        };
        let trace = traced(&scene);
        // Near the end stops their walls push as well.
        let free = -0.1..1.2;
        let mut furthest = 0.0_f64;
        for (angle, force) in trace.angle_rad.iter().zip(&trace.force_n_m) {
            furthest = furthest.max(*angle);
            let wrong = (force - listed(*angle)).abs();
            assert!(
                !free.contains(angle) || wrong <= 0.05 * most,
                "{grip}: {wrong} N·m wrong at {angle} rad"
            );
        }
        assert!(furthest > 1.2, "{grip}: {furthest} rad");
    }
}

/// Checks that a press on the lower end stop, whose force is negative, gives the same largest force, verdict and torque limit as a
/// press on the upper one.
#[test]
fn an_end_is_judged_alike_from_either_side() {
    let pressed = |angle: &str, sets: &[&str]| {
        let angle = format!("operator.motion.angle_rad={angle}");
        let scene = feel("hard-stops", &[&[&*angle], sets].concat());
        let recording = run(&scene, true).unwrap();
        let trace = recording.trace.unwrap();
        let most = trace
            .force_n_m
            .iter()
            .fold(0.0, |most: f64, force| most.max(force.abs()));
        assert_eq!(recording.summary.force_max, most, "{angle}");
        assert!(most > 0.03, "{angle}: {most}");
        recording.summary
    };
    // A spring alone, without guard: it swings up to the motor's limit while the hand stays.
    let swings = [
        "law.kind=spring",
        "law.guard.on=false",
        "law.states=measured",
        "operator.motion.stay_s=2",
        "timing.duration_s=3.3",
    ];
    for (sets, verdict) in [(&[][..], Verdict::Passive), (&swings, Verdict::Unstable)] {
        let [up, down] = ["4", "-4"].map(|angle| pressed(angle, sets));
        assert_eq!((up.verdict, down.verdict), (verdict, verdict), "{sets:?}");
        assert!((up.force_max - down.force_max).abs() < 1e-3, "{sets:?}");
    }
}

/// Checks that a program that counts detents by position, with a hysteresis of a quarter of their pitch, always has the knob's true
/// position.
#[test]
fn positions_are_neither_lost_nor_doubled() {
    for name in [
        "coarse-detents",
        "fine-detents",
        "multi-turn",
        "magnetic-detents",
        "ratchet",
    ] {
        let scene = feel(name, &[]);
        let around = scene.environment.clone().unwrap();
        let per_rev = match (around.detents, around.profile) {
            (Some(ring), _) => ring.per_rev,
            (_, profile) => profile.unwrap().per_rev,
        };
        let pitch = TAU / f64::from(per_rev);
        let trace = traced(&scene);
        let (mut position, mut crossings) = (0_i64, 0_u32);
        for angle in &trace.angle_rad {
            let beyond = angle / pitch - position as f64;
            if beyond.abs() > 0.75 {
                position += beyond.signum() as i64;
                crossings += 1;
            }
            assert!((angle / pitch - position as f64).abs() <= 0.75, "{name}");
        }
        assert!(crossings >= 6, "{name}: {crossings} crossings");
        assert_eq!(
            position,
            (trace.angle_rad.last().unwrap() / pitch).round() as i64,
            "{name}"
        );
    }
}

#[test]
fn a_scene_takes_from_its_base_what_it_does_not_write() {
    let parse = |text: &str| Scene::parse(text, Path::new("mine.toml"));
    let base = Scene::load("gimbal-knob").unwrap();
    let mine = parse("base = \"gimbal-knob\"\n[wall]\nk_desired_n_m_per_rad = 1.0\n").unwrap();
    assert_eq!(mine.name, "mine");
    assert_eq!(mine.wall.k_desired_n_m_per_rad, 1.0);
    assert_eq!(mine.wall.surface_rad, base.wall.surface_rad);
    assert_eq!(mine.device, base.device);
    assert_eq!(mine.law, base.law);
    // A scene with another motion has none of the base's motion fields, and one with another hand none of its grip.
    let other = parse("base = \"gimbal-knob\"\n[operator.hand]\ninertia_kg_m2 = 1e-4\n[operator.motion]\nkind = \"tap\"\n").unwrap();
    assert_eq!(other.operator.grip.name(), "custom");
    assert_eq!(other.operator.motion.name(), "tap");
    // A printed scene is complete without its base.
    assert_eq!(other, parse(&other.to_toml()).unwrap());
}

#[test]
fn a_base_that_is_none_is_named_with_its_line() {
    let refused = |text: &str| {
        Scene::parse(text, Path::new("mine.toml"))
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        refused("# mine\nbase = \"gimbal-knop\"\n"),
        "mine.toml:2: base: no shipped scene \"gimbal-knop\"; did you mean \"gimbal-knob\"?"
    );
    assert!(
        refused("base = 3\n").starts_with(
            "mine.toml:1: base: no shipped scene 3; give a shipped scene: thesis-knob"
        )
    );
    assert!(refused("base = \"./gimbal-knob.toml\"\n").contains("base: no shipped scene"));
    // An error in the extending scene is reported with that scene's line.
    let wrong = refused("base = \"gimbal-knob\"\n[wall]\nk_desired_n_m_per_rad = -1.0\n");
    assert!(
        wrong.starts_with("mine.toml:3: wall.k_desired_n_m_per_rad"),
        "{wrong}"
    );
}

/// Checks every shipped haptic effect with the scorecard of a feel: quiet at rest, the drawn torque within 5 %, every position
/// counted once, and no more energy for the hand than the energy guard allows. The torque of a flywheel in a slow turn is too small
/// for a comparison: fractions of a mN·m, to which the encoder's counts add as much.
#[test]
fn every_feel_has_a_clean_scorecard() {
    let (mut crossings, mut with_positions, mut compared) = (0, 0, 0);
    for name in scene::feels() {
        let card = feel_card(&feel(name, &[]), 200).unwrap();
        with_positions += u32::from(card.pitch_rad.is_some());
        for felt in &card.grips {
            let who = format!("{name} {}: {felt:?}", felt.grip);
            assert!(felt.buzz_counts <= 2.0, "{who}");
            assert!(felt.counts_right(), "{who}");
            assert!(felt.energy_out_j <= felt.energy_allowed_j, "{who}");
            if felt.drawn_n_m > 1e-3 {
                compared += 1;
                assert!((felt.peak_share.unwrap() - 1.0).abs() <= 0.05, "{who}");
            }
            crossings += felt.crossings;
        }
    }
    println!("{crossings} positions crossed");
    assert!(with_positions >= 16 && crossings > 200 * 3 * 16);
    assert!(compared >= 3 * 16, "{compared} torques compared");
}

/// Checks that the scorecard of a feel finds what it looks for: torque that the energy guard takes away, detents that buzz, and a
/// sensor whose noise makes positions change without a turn.
#[test]
fn a_scorecard_finds_what_is_wrong() {
    let card = |sets: &[&str]| feel_card(&feel("coarse-detents", sets), 200).unwrap().grips;
    let poor = card(&["law.guard.capacity_j=0.0002", "law.guard.refill_w=0"]);
    assert!(poor.iter().any(|it| it.peak_share < Some(0.95)));
    assert!(poor.iter().any(|it| it.limited_share[3] > 0.1), "{poor:?}");
    let stiff = card(&[
        "environment.detents.per_rev=400",
        "environment.detents.strength_n_m=0.045",
        "device.friction=none",
    ]);
    assert!(stiff.iter().any(|it| it.buzz_counts > 2.0), "{stiff:?}");
    let noisy = card(&[
        "environment.detents.per_rev=100",
        "environment.detents.strength_n_m=0.001",
        "sensor.noise.rms_rad=0.03",
    ]);
    assert!(
        noisy.iter().any(|it| it.doubled > 0 && it.lost > 0),
        "{noisy:?}"
    );
}

/// Checks feels that are hard to render: detents narrower than ten encoder counts, a profile whose torque falls from one limit to
/// the other within a hundredth of a turn, and a knob after 10,000 turns. The hand never gets more than the energy guard allows, no
/// position is lost, and the torque reaches the drawn strength to within 5 %. Only the turned knob must be quiet at rest.
#[test]
fn hard_feels_stay_within_their_bounds() {
    let cliff = "environment.profile.shape=[1.0,0.6,0.2,-0.2,-0.6,-1.0]";
    let cases: [(&str, &[&str], bool); 4] = [
        (
            "fine-detents",
            // 16,384 counts in a turn: 8.2 a detent.
            &[
                "environment.detents.per_rev=2000",
                "environment.detents.strength_n_m=0.002",
            ],
            false,
        ),
        (
            "magnetic-detents",
            &[
                cliff,
                "environment.profile.per_rev=15",
                "environment.profile.strength_n_m=0.02",
            ],
            false,
        ),
        (
            "coarse-detents",
            &["device.initial_angle_rad=62831.853071795864"],
            true,
        ),
        (
            "clicker",
            &["device.initial_angle_rad=-62831.853071795864"],
            true,
        ),
    ];
    for (name, sets, rests) in cases {
        for felt in feel_card(&feel(name, sets), 300).unwrap().grips {
            let who = format!("{name} {sets:?} {}: {felt:?}", felt.grip);
            assert!(felt.energy_out_j <= felt.energy_allowed_j, "{who}");
            assert!(felt.counts_right() && felt.crossings >= 300, "{who}");
            let share = felt.peak_share.unwrap();
            assert!((0.95..=1.05).contains(&share), "{who}");
            assert!(!rests || felt.buzz_counts <= 2.0, "{who}");
        }
    }
}
