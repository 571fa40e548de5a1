//! `cargo xtask prove --every [NAME]`: the properties of which all inputs are tried (`proofs/examples/every.rs`).

use std::process::Command;

use crate::outcome::Outcome;
use crate::shell;

/// The message when all of them hold.
pub const HOLD: &str = "all inputs of the properties that have few enough hold";
/// A property that takes a second: it runs where the checker is missing.
pub const SAMPLE: &str = "space::w8::p4_unit";

/// Tries the properties whose name contains `part`.
pub fn run(part: &str) -> Outcome {
    asked(trials(part), part)
}

/// Tries all properties, at low priority.
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
