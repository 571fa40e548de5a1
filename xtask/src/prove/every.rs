//! `cargo xtask prove --every [NAME]`: checks proved properties that have few enough inputs by trying all inputs
//! (`proofs/examples/every.rs`).

use std::process::Command;

use crate::outcome::Outcome;
use crate::shell;

/// Message of the outcome if every property that has few enough inputs holds for all of them.
pub const HOLD: &str = "all inputs of the properties that have few enough hold";
/// A property whose check with all inputs takes a second. It is checked where the model checker is not installed.
pub const SAMPLE: &str = "space::w8::p4_unit";

/// Tries all inputs of the properties whose names contain `part`.
pub fn run(part: &str) -> Outcome {
    asked(trials(part), part)
}

/// Tries all inputs of all properties that have few enough, at low process priority.
pub fn run_beside() -> Outcome {
    asked(shell::behind(&trials("")), "")
}

fn trials(part: &str) -> Command {
    let mut command = shell::cargo_locked("run");
    command.args(["--quiet", "--profile", "every", "-p", "touchstone-proofs"]);
    command.args(["--example", "every", "--", part]);
    command
}

fn asked(mut command: Command, part: &str) -> Outcome {
    if shell::run(&mut command).is_failure() {
        return Outcome::Failed(format!("`cargo xtask prove --every {part}`"));
    }
    Outcome::Ok(HOLD.into())
}
