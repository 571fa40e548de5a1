//! Tests the C library as a C program uses it: the system's C compiler compiles and links test programs, which are then run.

use std::path::{Path, PathBuf};
use std::process::Command;
use touchstone_control::fixed::types::I8F24;
use touchstone_control::{
    Choice, Controller, Fixed32, Force, Guard, GuardSettings, Guarded, GuardedDevice, LawKind,
    Position, PositionSettings, Settings, Si,
};

const ROOT: &str = env!("CARGO_MANIFEST_DIR");

/// Path of the static C library, which cargo builds next to this test and in the same profile.
fn library() -> PathBuf {
    let test = std::env::current_exe().expect("this test's path");
    let folder = test.parent().expect("deps");
    let built = std::fs::read_dir(folder).expect("deps can be read");
    let newest = built
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            name.starts_with("libtouchstone_c") && name.ends_with(".a")
        })
        .max_by_key(|path| path.metadata().and_then(|it| it.modified()).ok());
    newest.expect("libtouchstone_c.a beside the test")
}

/// Compiles a C file with warnings as errors, and runs the program. Without a C compiler it prints a note and returns `None`.
fn run(name: &str, source: &Path, flags: &[&str]) -> Option<std::process::Output> {
    if Command::new("cc").arg("--version").output().is_err() {
        eprintln!("not run: no C compiler `cc` here");
        return None;
    }
    let program = std::env::temp_dir().join(format!("touchstone-c-{name}-{}", std::process::id()));
    let built = Command::new("cc")
        .args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-O1"])
        .args(flags)
        .arg(format!("-I{ROOT}/include"))
        .arg(source)
        .arg(library())
        .args(["-lpthread", "-ldl", "-lm", "-o"])
        .arg(&program)
        .output()
        .expect("cc can be started");
    assert!(
        built.status.success(),
        "{}",
        String::from_utf8_lossy(&built.stderr)
    );
    let ran = Command::new(&program).output().expect("the program");
    let _ = std::fs::remove_file(&program);
    Some(ran)
}

fn example(name: &str) -> PathBuf {
    Path::new(ROOT).join("examples").join(name)
}

#[test]
fn the_guard_holds_an_end_stop_that_runs_away_without_it() {
    if let Some(ran) = run("end_stop", &example("end_stop.c"), &[]) {
        assert!(
            ran.status.success(),
            "{}",
            String::from_utf8_lossy(&ran.stdout)
        );
    }
}

/// Repeats the million control periods of `examples/hostile.c` in Rust and returns the digest that the C program must print.
fn digest_of_the_rust_code() -> u64 {
    let mut state = 0x2545_F491_u32;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        state
    };
    let mut digest = 0xCBF2_9CE4_8422_2325_u64;
    let mut add = |value: i32| {
        digest = (digest ^ u64::from(value.cast_unsigned())).wrapping_mul(0x0100_0000_01B3);
    };
    let si = |text: &str| text.parse::<Si>().expect("a number");
    let device = GuardedDevice {
        rate_hz: 1000,
        force_limit: si("0.5"),
        // `TS_SI` rounds towards zero where `Si` rounds to nearest.
        count: Si::from_bits((0.000_157_079_633_f64 * 4_294_967_296.0) as i64),
    };
    let shipped = GuardSettings {
        damping: Si::from_bits((0.0004_f64 * 4_294_967_296.0) as i64),
        ..GuardSettings::default()
    };
    let made = Guard::new(&shipped, &device).expect("a guard");
    let mut guard = Guarded::<Fixed32>::new(made);
    let settings = Settings {
        k_desired: si("14"),
        law: LawKind::of_word("enhanced-sfa").expect("a law"),
        ..Settings::default()
    };
    let fresh = Controller::<Fixed32>::new(&settings).expect("a wall");
    let mut wall = fresh;
    let (signal, ok, overspeed) = (I8F24::from_bits, 0, 6);
    for _ in 0..1_000_000 {
        let chance = next();
        let moved = if chance % 1000 == 0 {
            next().cast_signed()
        } else {
            (next() % 1_000_001).cast_signed() - 500_000
        };
        let wanted = next().cast_signed();
        let allowed = guard.moved(
            Position(signal(moved)),
            Position(signal(moved / 3)),
            Force(signal(wanted)),
        );
        add(allowed.0.to_bits());
        add(if guard.tripped { overspeed } else { ok });
        if guard.tripped {
            guard = Guarded::new(made).resumed(&guard);
        }
        if chance % 7 == 0 {
            guard.commanded(Force(signal(allowed.0.to_bits() / 2)));
        }
        let small = (next() % 200_001).cast_signed() - 100_000;
        let far = if chance % 5000 == 0 {
            next().cast_signed() / 4
        } else {
            0
        };
        let force = wall.tick(Position(signal(small + far)));
        add(force.0.to_bits());
        add(if wall.tripped() { overspeed } else { ok });
        if wall.tripped() {
            wall.resume(&fresh);
        }
    }
    digest
}

#[test]
fn a_million_hostile_ticks_from_c_have_the_bits_of_the_rust_code() {
    let expected = format!("{:016x}", digest_of_the_rust_code());
    if let Some(ran) = run("hostile", &example("hostile.c"), &["-fsanitize=undefined"]) {
        assert!(ran.status.success(), "{:?}", ran.status);
        assert_eq!(String::from_utf8_lossy(&ran.stdout).trim(), expected);
    }
}

/// The settings that `touchstone tune` wrote for a simulated knob, as Rust and, beside it, as C.
mod tuned {
    include!("tuned/sample.rs");
}

#[test]
fn tuned_settings_in_c_are_those_in_rust() {
    let expected = tuned::tuned_settings();
    let mut wall = Controller::<Fixed32>::new(&expected).expect("a wall");
    let digest = (0..2000_i32).fold(0_u32, |digest, tick| {
        let depth = (tick % 200).min(200 - tick % 200) * 1342;
        let force = wall.tick(Position(I8F24::from_bits(depth)));
        digest
            .wrapping_mul(31)
            .wrapping_add(force.0.to_bits().cast_unsigned())
    });
    let source = Path::new(ROOT).join("tests/tuned/print.c");
    for name in ["sample.c", "sample.h"] {
        let included = format!("-DTUNED=\"{ROOT}/tests/tuned/{name}\"");
        let Some(ran) = run(&name.replace('.', "_"), &source, &[&included]) else {
            return;
        };
        let said = String::from_utf8_lossy(&ran.stdout);
        assert!(ran.status.success(), "{name}: {:?}: {said}", ran.status);
        let mut settings = Settings::default();
        for line in said.lines() {
            let (path, value) = line.split_once(' ').expect("two words");
            let number = value.parse();
            match path {
                "counts" => {
                    settings.position = PositionSettings::of_counts_per_rev(number.expect("counts"))
                }
                "digest" => assert_eq!(number, Ok(digest), "{name}"),
                path => assert_eq!(settings.set_by_path(path, value), Ok(()), "{line}"),
            }
        }
        assert!(said.contains("digest"), "{name}: {said}");
        assert_eq!(settings, expected, "{name}");
    }
}

#[test]
fn wrong_calls_answer_and_give_no_force() {
    let source = std::env::temp_dir().join(format!("touchstone-c-wrong-{}.c", std::process::id()));
    std::fs::write(&source, include_str!("wrong_calls.c")).expect("a file");
    let ran = run("wrong", &source, &[]);
    let _ = std::fs::remove_file(&source);
    if let Some(ran) = ran {
        let said = String::from_utf8_lossy(&ran.stdout).into_owned();
        assert!(ran.status.success(), "line {:?}: {said}", ran.status.code());
    }
}
