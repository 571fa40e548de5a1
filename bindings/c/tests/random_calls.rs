//! Calls the C functions in random order with random arguments, under sanitizers.

mod program;

use program::{Program, SANITIZERS, number};
use touchstone_control::Field;

/// Makes 100,000 random calls, or as many as `TOUCHSTONE_CALLS` says; `TOUCHSTONE_SEED` sets the seed.
#[test]
fn random_calls_get_defined_answers() {
    let mut arguments = vec![
        number("TOUCHSTONE_CALLS", 100_000).to_string(),
        number("TOUCHSTONE_SEED", 1).to_string(),
    ];
    arguments.extend(Field::ALL.iter().map(|field| field.path().to_owned()));
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    Program::c("fuzz_calls", &["tests/fuzz_calls.c"])
        .with(&SANITIZERS)
        .said(&arguments);
}
