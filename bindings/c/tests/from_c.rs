//! Tests the C library as a C program uses it: examples that calculate something, and wrong calls.

mod program;

use program::{Program, SANITIZERS};

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

#[test]
fn wrong_calls_answer_and_give_no_force() {
    Program::c("wrong_calls", &["tests/wrong_calls.c"])
        .with(&SANITIZERS)
        .said(&[]);
}
