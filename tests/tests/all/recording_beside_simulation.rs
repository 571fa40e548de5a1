//! Tests the comparison of a device's recording with its simulation. A knob that equals its description in the scene file agrees.
//! For another knob the comparison names the property that differs. For the whole drive (control code, current loop and motor) only
//! a bounce off the wall is compared, because the coarse current sensors of a motor shield dominate slow motion.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use touchstone_control::Si;
use touchstone_drive::DeviceSettings;
use touchstone_lab::beside::{Beside, HandWas, WallRecording, beside};
use touchstone_protocol::{Board, Telemetry};
use touchstone_sim::run::run;
use touchstone_sim::scene::{Encoder, Friction, Grip, MotionSpec, Scene};
use touchstone_tests::knob::{Honest, Knob, PERIOD_S};
use touchstone_world::motor::{GIMBAL, KNOB};
use touchstone_world::plant::{BareCoulomb, Coulomb, Device, State};

const FRICTION_N_M: f64 = 1e-3;
const COUNTS: u32 = 16_384;

fn settings() -> DeviceSettings {
    let mut settings = DeviceSettings::defaults(Board::NucleoG474re);
    settings.wall.surface_rad = Si::lit("0.3");
    settings.limits.fade_in_s = Si::lit("0.05");
    // A damper's force follows every count, and the current loop smooths it. So only the spring's force is compared.
    settings.law.virtual_damping_n_m_s_per_rad = Si::ZERO;
    // A pulse at the touch stops a light knob before the wall, and the spring never shows.
    settings.law.impact.share_of_momentum = Si::ZERO;
    settings.encoder.counts_per_rev = COUNTS;
    settings
}

/// Description of a simulation in which a hand presses twice: the knob of the DLR thesis, with friction and an encoder.
fn said() -> Scene {
    let friction = Friction {
        kinetic_n_m: FRICTION_N_M,
        ..Friction::default()
    };
    let change = |scene: &mut Scene| {
        scene.device.friction = Some(friction);
        scene.encoder = Some(Encoder {
            counts_per_rev: f64::from(COUNTS),
        });
        scene.timing.computational_delay_s = 7.5e-5;
        scene.law.virtual_damping_n_m_s_per_rad = 0.0;
        scene.law.impact.share_of_momentum = 0.0;
    };
    Scene::load("thesis-knob").unwrap().with(change).unwrap()
}

/// As `said`, but without a hand: the simulated knob is flicked against the wall and let go.
fn flicked() -> Scene {
    let change = |scene: &mut Scene| {
        scene.operator.grip = Grip::None;
        scene.operator.motion = MotionSpec::None;
        scene.device.initial_angle_rad = Some(scene.wall.surface_rad - 0.3);
        scene.device.initial_velocity_rad_per_s = 6.0;
        scene.timing.duration_s = 0.8;
    };
    said().with(change).unwrap()
}

/// Writes a recording file as `touchstone monitor` does: count, penetration and force of each control tick. Returns its path.
fn kept(test: &str, ticks: impl Iterator<Item = (String, String, String)>) -> PathBuf {
    let mut text = String::from("tick,time_s,count,penetration_rad,force_n_m,state,limits\n");
    for (tick, (count, penetration, force)) in ticks.enumerate() {
        let time_s = 1e-3 * tick as f64;
        let tick = tick + 7_000;
        let _ = writeln!(text, "{tick},{time_s},{count},{penetration},{force},armed,");
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("beside-{test}"));
    // Files of an earlier run would not be overwritten.
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let file = folder.join("record.csv");
    std::fs::write(&file, text).unwrap();
    file
}

/// Runs a simulation and writes the result as a recording of a device. Returns the file's path.
fn simulated(test: &str, of: &Scene) -> PathBuf {
    let trace = run(of, true).unwrap().trace.unwrap();
    let step = std::f64::consts::TAU / f64::from(COUNTS);
    let both = trace.angle_measured_rad.into_iter().zip(trace.force_n_m);
    let surface = of.wall.surface_rad;
    let told = both.map(|(angle, force)| {
        let count = (angle / step).round().to_string();
        (count, (angle - surface).to_string(), force.to_string())
    });
    kept(test, told)
}

fn compared(test: &str, file: &Path, scene: &Scene, hand: HandWas) -> Beside {
    let told = WallRecording::read(file, 0.0, f64::INFINITY).unwrap();
    let found = beside(scene, &told, hand, file.parent().unwrap()).unwrap();
    println!("{test}: {:#?} {:?}", found.differences, found.fits);
    found
}

/// Allowed difference between recording and simulation, as a fraction of a flick's span of 0.2 rad and 76 mN·m. The force of one
/// encoder count (0.4 mrad at 5 N·m/rad) is 0.025 of that torque.
const LIKE: f64 = 0.02;

#[test]
fn a_flicked_knob_like_its_scene_stays_with_it() {
    let file = simulated("like", &flicked());
    let found = compared("like", &file, &flicked(), HandWas::Gone);
    assert!(found.holds(LIKE), "{:?}", found.differences);
    assert_eq!(found.differences[0].parts_at_s, None);
}

#[test]
fn a_flicked_knob_of_other_inertia_damping_or_friction_is_told() {
    let with = |inertia: f64, damping: f64, friction: f64| {
        flicked().with(|scene| {
            scene.device.inertia_kg_m2 *= inertia;
            scene.device.damping_n_m_s_per_rad *= damping;
            let dry = scene.device.friction.as_mut().unwrap();
            dry.kinetic_n_m *= friction;
        })
    };
    for (test, of, field, factor) in [
        ("heavy", with(1.3, 1.0, 1.0), "device.inertia_kg_m2", 1.3),
        ("light", with(0.7, 1.0, 1.0), "device.inertia_kg_m2", 0.7),
        (
            "lossy",
            with(1.0, 1.3, 1.0),
            "device.damping_n_m_s_per_rad",
            1.3,
        ),
        (
            "easy",
            with(1.0, 0.7, 1.0),
            "device.damping_n_m_s_per_rad",
            0.7,
        ),
        (
            "dry",
            with(1.0, 1.0, 1.3),
            "device.friction.kinetic_n_m",
            1.3,
        ),
    ] {
        let file = simulated(test, &of.unwrap());
        let found = compared(test, &file, &flicked(), HandWas::Gone);
        assert!(!found.holds(LIKE), "{test}: {:?}", found.differences);
        assert!(found.differences[0].parts_at_s.is_some());
        let best = &found.fits[0];
        assert_eq!(best.field, field, "{test}: {:?}", found.fits);
        assert!(
            (best.factor / factor - 1.0).abs() < 0.05,
            "{test}: {best:?}"
        );
    }
}

#[test]
fn a_held_knob_like_its_scene_stays_with_it() {
    let file = simulated("held", &said());
    let found = compared("held", &file, &said(), HandWas::Holding);
    assert!(found.holds(0.05), "{:?}", found.differences);
    // At another wall the same hand moves differently.
    let soft = said().with(|scene| scene.wall.k_desired_n_m_per_rad *= 0.7);
    let file = simulated("soft", &soft.unwrap());
    let found = compared("soft", &file, &said(), HandWas::Holding);
    assert!(!found.holds(0.05), "{:?}", found.differences);
}

/// Allowed difference between recording and simulation, as a fraction of the 65 mN·m with which the knob bounces off the wall. Half
/// a step of the shield's current sensor (7.8 mA at 0.25 N·m/A) is 0.03 of that torque.
const COARSE: f64 = 0.03;

/// Checks that the inertia of the whole drive (control code, current loop and motor) can be identified from a bounce off the wall.
#[test]
fn a_bounce_of_the_whole_drive_tells_the_inertia() {
    for inertia in [0.7, 1.0, 1.3] {
        let device = Device {
            inertia: inertia * KNOB.inertia,
            damping: KNOB.damping,
            friction: Some(Coulomb {
                kinetic: FRICTION_N_M,
                breakaway: FRICTION_N_M,
            }),
        };
        let plant = BareCoulomb::new(&device, PERIOD_S / 2.0).unwrap();
        let mut knob = Knob::with_plant(&settings(), GIMBAL, plant, 0.0, Honest).armed();
        for _ in 0..200 {
            knob.tick();
        }
        let angle = knob.rig.now().angle_rad;
        *knob.rig.state_mut() = State::from_array([angle, 6.0]);
        let mut touched = 0;
        let told = std::iter::from_fn(|| {
            let record = Telemetry::from(&knob.tick());
            touched += u32::from(touched > 0 || record.penetration_rad > 0);
            // The flight before the wall and one bounce; after that the shield's coarse current steps dominate.
            (touched < 20).then(|| {
                let (count, penetration) = (record.count, record.penetration_rad);
                (
                    count.to_string(),
                    penetration.to_string(),
                    record.force_n_m.to_string(),
                )
            })
        });
        let test = format!("drive-{inertia}");
        let file = kept(&test, told);
        let found = compared(&test, &file, &said(), HandWas::Gone);
        let fit = found
            .fits
            .iter()
            .find(|fit| fit.field == "device.inertia_kg_m2");
        let factor = fit.unwrap().factor;
        assert!((factor / inertia - 1.0).abs() < 0.1, "{inertia}: {factor}");
        assert_eq!(
            found.holds(COARSE),
            inertia == 1.0,
            "{:?}",
            found.differences
        );
    }
}

#[test]
fn what_does_not_fit_the_scene_is_refused() {
    let away = flicked().with(|scene| scene.device.initial_velocity_rad_per_s = -6.0);
    let file = simulated("refused", &away.unwrap());
    let told = WallRecording::read(&file, 0.0, f64::INFINITY).unwrap();
    let why = |scene: &Scene| {
        let refused = beside(scene, &told, HandWas::Gone, file.parent().unwrap());
        refused.expect_err("it does not fit").to_string()
    };
    assert!(why(&said()).contains("never reached the wall"));
    let slow = said().with(|scene| scene.timing.rate_hz = 500).unwrap();
    assert!(why(&slow).contains("recorded at 1000.0 Hz, the scene runs at 500 Hz"));
    let coarse = said().with(|scene| {
        scene.encoder = Some(Encoder {
            counts_per_rev: 4000.0,
        })
    });
    assert!(
        why(&coarse.unwrap()).contains("not whole counts of an encoder with 4000 counts a turn")
    );
    let short = WallRecording::read(&file, 0.0, 0.05).expect_err("too short");
    assert!(
        short.to_string().contains("no 0.1 s with the wall on"),
        "{short}"
    );
}
