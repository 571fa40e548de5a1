//! Compiles the examples for Arduino, SimpleFOC and ST's HAL against declarations of the functions that they use of these
//! platforms, and runs them on simulated hardware. Checks the files with which Arduino and PlatformIO recognise the library; `cargo
//! xtask arduino` packs it.

mod program;

use program::{Program, SANITIZERS};

/// Lets the test programs see which torque an example reports to the guard.
const REPORTED: &str = "-Dts_guard_commanded=reported";

#[test]
fn the_guarded_pid_on_arduino_keeps_its_bound_with_a_wrong_sign() {
    Program::cpp(
        "guarded-pid",
        &[
            "examples/guarded_pid/guarded_pid.ino",
            "tests/stand_in/run_guarded_pid.cpp",
        ],
    )
    .with_headers("tests/stand_in")
    .with(&SANITIZERS)
    .with(&[REPORTED])
    .said(&[]);
}

/// Checks that the library's description has all fields that Arduino's specification demands, and the same name and version for
/// PlatformIO.
#[test]
fn arduino_and_platformio_are_told_all_that_they_demand() {
    let text = include_str!("../arduino/library.properties");
    let value = |key: &str| {
        let line = text
            .lines()
            .find_map(|line| line.strip_prefix(key)?.strip_prefix('='));
        line.filter(|value| !value.is_empty())
            .unwrap_or_else(|| panic!("library.properties has no {key}"))
    };
    for key in [
        "author",
        "maintainer",
        "sentence",
        "paragraph",
        "url",
        "architectures",
    ] {
        value(key);
    }
    assert!(value("name").chars().all(|c| c.is_ascii_alphanumeric()));
    assert_eq!(value("version"), env!("CARGO_PKG_VERSION"));
    assert_eq!(value("category"), "Device Control");
    assert_eq!(value("includes"), "touchstone.h");
    assert_eq!(value("precompiled"), "full");
    assert_eq!(value("ldflags"), "-ltouchstone_c");
    let json = include_str!("../arduino/library.json");
    for row in [
        format!("\"name\": \"{}\"", value("name")),
        format!("\"version\": \"{}\"", env!("CARGO_PKG_VERSION")),
        "\"extraScript\": \"choose_library.py\"".into(),
    ] {
        assert!(json.contains(&row), "library.json has no {row}");
    }
}

#[test]
fn the_simplefoc_knob_has_a_wall_and_switches_off_when_it_is_too_fast() {
    for (name, direction) in [
        ("simplefoc", "-DSENSOR_DIRECTION=1"),
        ("simplefoc-reversed", "-DSENSOR_DIRECTION=-1"),
    ] {
        Program::cpp(
            name,
            &[
                "examples/simplefoc_knob/simplefoc_knob.ino",
                "tests/stand_in/run_simplefoc_knob.cpp",
            ],
        )
        .with_headers("tests/stand_in")
        .with(&SANITIZERS)
        .with(&[direction])
        .said(&[]);
    }
}

#[test]
fn the_guard_in_an_stm32_interrupt_takes_a_wrong_sign_s_force_away() {
    Program::c(
        "stm32",
        &["examples/stm32_hal.c", "tests/stand_in/run_stm32.c"],
    )
    .with_headers("tests/stand_in")
    .with(&SANITIZERS)
    .with(&[REPORTED])
    .said(&[]);
}
