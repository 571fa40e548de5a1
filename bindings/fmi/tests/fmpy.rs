//! Tests of the FMUs with FMPy, an independent program for FMUs. FMPy validates the FMUs and runs law and plant in turn. The
//! results must equal those of the scene's run in every bit.
//!
//! Skipped, with a line that says so, if Python has no `fmpy`. The environment variable `TOUCHSTONE_PYTHON` names another Python.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use touchstone_fmu::{Half, description, export};
use touchstone_sim::run::{Recorder, Tick, watch};
use touchstone_sim::scene::Scene;

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// The shared library, which cargo builds next to this test and in the same profile.
fn library() -> Vec<u8> {
    let test = std::env::current_exe().expect("this test's path");
    let file = test.with_file_name(export::library_name());
    export::library(&file).expect("the library beside the test")
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("fmu-{name}"));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Writes both FMUs of a scene; returns their paths, the law's first.
fn written(folder: &Path, scene: &Scene) -> [PathBuf; 2] {
    let library = library();
    Half::ALL.map(|half| {
        let file = folder.join(format!("{}.fmu", description::identifier(scene, half)));
        let bytes = export::fmu(scene, half, &library).expect("an FMU");
        assert_eq!(bytes, export::fmu(scene, half, &library).expect("the same"));
        std::fs::write(&file, bytes).expect("a file");
        file
    })
}

fn python(script: &str, words: &[PathBuf]) -> Option<Output> {
    let python = std::env::var_os("TOUCHSTONE_PYTHON").unwrap_or_else(|| "python3".into());
    let ran = Command::new(python)
        .arg(Path::new(ROOT).join(script))
        .args(words)
        .output();
    ran.ok()
}

/// Whether FMPy is installed and finds no fault in the FMUs.
fn is_valid(files: &[PathBuf]) -> bool {
    let Some(ran) = python("tests/checked.py", files) else {
        println!("skipped: there is no python3");
        return false;
    };
    let said = String::from_utf8_lossy(&ran.stdout);
    println!("{said}");
    if ran.status.code() == Some(9) {
        println!("skipped: python3 has no fmpy (pip install fmpy)");
        return false;
    }
    let complaint = String::from_utf8_lossy(&ran.stderr);
    assert!(ran.status.success(), "{said}{complaint}");
    assert!(!said.contains("[ERROR]"), "{said}");
    true
}

struct All(Vec<Tick>);

impl Recorder for All {
    fn record(&mut self, tick: &Tick) {
        self.0.push(*tick);
    }
}

/// Compares the pair of FMUs that FMPy ran with the scene's run, number by number. Returns the number of ticks.
fn compare(name: &str, scene: &Scene) -> usize {
    let folder = folder(name);
    let files = written(&folder, scene);
    if !is_valid(&files) {
        return usize::MAX;
    }
    let ran = python("examples/couple.py", &files).expect("python");
    let complaint = String::from_utf8_lossy(&ran.stderr);
    assert!(ran.status.success(), "{complaint}");
    let ticks = watch(scene, All(Vec::new())).expect("a run").0;
    let table = String::from_utf8(ran.stdout).expect("a table");
    let rows: Vec<&str> = table.lines().skip(1).collect();
    assert_eq!(rows.len(), ticks.len());
    let limit_n_m = scene.device.torque_limit_n_m.unwrap_or(f64::INFINITY);
    for (row, tick) in rows.iter().zip(&ticks) {
        let found: Vec<u64> = row
            .split(',')
            .map(|number| number.parse::<f64>().expect("a number").to_bits())
            .collect();
        let account_j = tick.inside.guard.map_or(0.0, |guard| guard.account_j);
        // Without other effects on the torque, the command is the law's force with the other sign, limited to the motor's limit. A
        // zero may have either sign.
        let torque_n_m = (0.0 - tick.force_n_m).clamp(-limit_n_m, limit_n_m);
        let expected = [tick.time_s, tick.angle_rad, torque_n_m, account_j];
        let same = found.iter().zip(expected).all(|(found, expected)| {
            *found == expected.to_bits() || expected == 0.0 && f64::from_bits(*found) == 0.0
        });
        assert!(
            same,
            "{name}, tick {}: {row} is not {expected:?}",
            tick.index
        );
    }
    ticks.len()
}

#[test]
fn fmpy_validates_the_fmus_and_runs_them_to_the_bits_of_the_program() {
    let scene = Scene::load("press-wiggle-release").expect("a scene");
    let rate_hz = f64::from(scene.timing.rate_hz);
    let long = format!("timing.duration_s={}", 100_001.0 / rate_hz);
    let scene = scene.with_overrides(&[long]).expect("a scene");
    assert!(compare("long", &scene) > 100_000);
}

/// Runs four scenes: with a recording, whose file is in the FMU; with a second encoder reading; without guard and hand; with
/// detents.
#[test]
fn fmpy_runs_scenes_of_other_variables() {
    let here = folder("others");
    let rows: String = (0..400)
        .map(|row| {
            format!(
                "{},{}\n",
                f64::from(row) * 1e-3,
                0.2 + f64::from(row) * 1e-3
            )
        })
        .collect();
    let recording = here.join("turn & back.csv");
    std::fs::write(&recording, format!("time_s,angle_rad\n{rows}")).expect("a file");
    let tap = Scene::load("tap").expect("a scene");
    let recorded = tap.with_recording(&recording).expect("a recording");
    let sets = |scene: &Scene, sets: &[&str]| {
        let sets: Vec<String> = sets.iter().map(ToString::to_string).collect();
        scene.with_overrides(&sets).expect("a scene")
    };
    let twice = [
        "timing.computational_delay_s=1e-4",
        "law.guard.delay_s=1e-4",
        "law.guard.change=measured",
    ];
    let bare = [
        "law.guard.on=false",
        "operator.grip=none",
        "operator.motion.kind=none",
        "device.initial_velocity_rad_per_s=3",
    ];
    for (name, scene) in [
        ("recorded", recorded),
        ("twice", sets(&tap, &twice)),
        ("bare", sets(&tap, &bare)),
        ("feel", Scene::load("coarse-detents").expect("a scene")),
    ] {
        compare(name, &scene);
    }
}
