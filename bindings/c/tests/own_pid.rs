//! Tests of the firmware `examples/own_pid.c`, which puts the guard around a PID controller: on a simulated knob, and against a
//! search for the hand and the law that get the most energy out.

mod program;

use program::{Program, SANITIZERS, file, number};

/// Replaces the guard by the motor's force limit alone, to show that the tests can fail.
const WITHOUT_GUARD: &str = "-Dts_guard_tick=without_guard";

fn bench() -> Program {
    Program::c(
        "own_pid",
        &["examples/own_pid.c", "examples/own_pid_bench.c"],
    )
}

#[test]
fn the_guard_bounds_a_pid_that_swings_up() {
    bench().with(&SANITIZERS).said(&[]);
    if let Some(ran) = bench().with(&[WITHOUT_GUARD]).run(&[]) {
        print!("without: {}", String::from_utf8_lossy(&ran.stdout));
        assert_eq!(ran.status.code(), Some(1), "it is bounded without a guard");
    }
}

#[test]
fn the_firmware_with_the_guard_has_at_most_forty_lines() {
    let source = std::fs::read_to_string(file("examples/own_pid.c")).expect("own_pid.c");
    let code = source
        .lines()
        .map(str::trim)
        .filter(|line| !line.is_empty() && !line.starts_with("/*") && !line.starts_with('*'));
    assert!(code.count() <= 40);
}

fn adversary() -> Program {
    Program::c("adversary", &["examples/own_pid.c", "tests/adversary.c"]).with(&["-O2"])
}

/// Tries 2,000 combinations of hand and law, or as many as `TOUCHSTONE_ADVERSARY` says, against the C functions alone. The program
/// also fails if it finds less than half of the bound: a search that finds nothing shows nothing.
#[test]
fn no_hand_and_law_get_more_out_of_the_guarded_firmware_than_promised() {
    let evaluations = number("TOUCHSTONE_ADVERSARY", 2_000).to_string();
    adversary().said(&[&evaluations]);
    if let Some(ran) = adversary().with(&[WITHOUT_GUARD]).run(&["300"]) {
        print!("without: {}", String::from_utf8_lossy(&ran.stdout));
        assert_eq!(
            ran.status.code(),
            Some(1),
            "the bound holds without a guard"
        );
    }
}
