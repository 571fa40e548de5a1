//! Compiles the examples for SimpleFOC and ST's HAL against declarations of what they use of these platforms, and runs them on
//! simulated hardware.

mod program;

use program::{Program, SANITIZERS};

#[test]
fn the_simplefoc_knob_has_a_wall_and_switches_off_when_it_is_too_fast() {
    Program::cpp(
        "simplefoc",
        &[
            "examples/simplefoc_knob/simplefoc_knob.ino",
            "tests/stand_in/run_simplefoc.cpp",
        ],
    )
    .with_headers("tests/stand_in")
    .with(&SANITIZERS)
    .said(&[]);
}

#[test]
fn the_guard_in_an_stm32_interrupt_takes_a_wrong_sign_s_force_away() {
    Program::c(
        "stm32",
        &["examples/stm32_hal.c", "tests/stand_in/run_stm32.c"],
    )
    .with_headers("tests/stand_in")
    .with(&SANITIZERS)
    .said(&[]);
}
