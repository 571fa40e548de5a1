//! `cargo xtask prove --elf [--mutants] [NAME]`: ticks of a board's program are their specification, by what its machine code does
//! (`proofs/elf/`).

use std::path::PathBuf;
use std::time::Instant;

use crate::outcome::Outcome;
use crate::{firmware, shell};

/// The board whose program is looked at.
const BOARD: &str = "nucleo-g474re";
/// Ticks of the Rust code that the checker's specification repeats.
const TICKS: &str = "20000";

/// All ticks, or those whose name contains a part.
pub fn run(part: &str) -> Outcome {
    let begun = Instant::now();
    match checked(&["--only", part]) {
        Ok(Outcome::Ok(_)) => Outcome::Ok(format!(
            "ticks of the program of {BOARD} are their specification ({} s)",
            begun.elapsed().as_secs()
        )),
        Ok(outcome) | Err(outcome) => outcome,
    }
}

/// Wrong changes of the program's bytes.
pub fn mutants(part: &str) -> Outcome {
    match checked(&["--mutants", "--only", part]) {
        Ok(Outcome::Ok(_)) => Outcome::Ok("every wrong change of the program refuted".into()),
        Ok(outcome) | Err(outcome) => outcome,
    }
}

/// The checker's own outcome; what it needs is made before.
fn checked(options: &[&str]) -> Result<Outcome, Outcome> {
    let python = super::with_wheels("elf-venv", "proofs/elf/requirements.txt")?;
    let program = firmware::build(BOARD)?;
    let trace = traced()?;
    let mut check = shell::program(&python);
    check
        .arg("proofs/elf/check.py")
        .args([&program, &trace])
        .args(options);
    Ok(shell::run(&mut check))
}

/// Ticks of the Rust code, in a file.
fn traced() -> Result<PathBuf, Outcome> {
    let mut command = shell::cargo_locked("run");
    command.args(["--release", "-q", "-p", "touchstone-proofs"]);
    command.args(["--example", "trace", "--", TICKS]);
    let path = shell::target("elf-trace.txt");
    let written = std::fs::File::create(&path).and_then(|file| command.stdout(file).status());
    match written {
        Ok(status) if status.success() => Ok(path),
        Ok(_) => Err(Outcome::Failed("the example `trace` failed".into())),
        Err(why) => Err(Outcome::Failed(format!("the example `trace`: {why}"))),
    }
}
