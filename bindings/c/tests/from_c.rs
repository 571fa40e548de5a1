//! Tests the C library as a C program uses it: examples that calculate something, and wrong calls.

mod program;

use program::{Program, ROOT, SANITIZERS};
use touchstone_control::fixed::types::I8F24;
use touchstone_control::{Controller, Fixed32, Position, PositionSettings, Settings};

#[test]
fn the_guard_holds_an_end_stop_that_runs_away_without_it() {
    Program::c("end_stop", &["examples/end_stop.c"])
        .with(&SANITIZERS)
        .said(&[]);
}

#[test]
fn a_dial_rests_in_a_detent_and_stops_at_its_end() {
    Program::c("detent_dial", &["examples/detent_dial.c"])
        .with(&SANITIZERS)
        .said(&[]);
}

/// The settings that `touchstone tune` wrote for a simulated knob, as Rust and, beside it, as C.
mod tuned {
    include!("tuned/sample.rs");
}

#[test]
fn tuned_settings_in_c_are_those_in_rust() {
    let expected = tuned::tuned_settings();
    let guard = tuned::tuned_device().guard_settings();
    assert_eq!(
        (guard.delay, guard.lag, guard.damping),
        (
            expected.guard.delay,
            expected.guard.lag,
            expected.guard.damping
        )
    );
    let mut wall = Controller::<Fixed32>::new(&expected).expect("a wall");
    let digest = (0..2000_i32).fold(0_u32, |digest, tick| {
        let depth = (tick % 200).min(200 - tick % 200) * 1342;
        let force = wall.tick(Position(I8F24::from_bits(depth)));
        digest
            .wrapping_mul(31)
            .wrapping_add(force.0.to_bits().cast_unsigned())
    });
    for name in ["sample.c", "sample.h"] {
        let included = format!("-DTUNED=\"{ROOT}/tests/tuned/{name}\"");
        let print = Program::c("tuned", &["tests/tuned/print.c"]).with(&[&included]);
        let Some(said) = print.said(&[]) else {
            return;
        };
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
    Program::c("wrong_calls", &["tests/wrong_calls.c"])
        .with(&SANITIZERS)
        .said(&[]);
}
