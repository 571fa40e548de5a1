//! `cargo xtask prove --elf [--mutants] [--board BOARD] [NAME]`: proves from the machine code of a board's firmware that functions
//! equal their specification (`proofs/elf/`).

use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::outcome::Outcome;
use crate::{firmware, inspect, shell};

/// The board whose firmware is proved if the command names none.
pub const BOARD: &str = "nucleo-g474re";
/// Number of control periods (ticks) on which the specification is compared with the Rust code.
const TICKS: &str = "20000";

/// Proves the control period (tick) functions in a board's machine code whose names contain `part`; with an empty `part`, all of
/// them.
pub fn run(board: &str, part: &str) -> Outcome {
    let begun = Instant::now();
    match checked(board, &["--only", part]) {
        Ok(Outcome::Ok(_)) => Outcome::Ok(format!(
            "what is named above, of the program of {board}, is its specification ({} s)",
            begun.elapsed().as_secs()
        )),
        Ok(outcome) | Err(outcome) => outcome,
    }
}

/// Runs the functions of the control period in the machine code on sample inputs, without a proof. It shows that checker,
/// specification and program still fit together.
pub fn readings() -> Outcome {
    // A failed build is not reported as an error here: `cargo xtask firmware` does that.
    if firmware::build(BOARD).is_err() {
        return Outcome::NotRun(format!("the program of {BOARD} is not built here"));
    }
    match checked(BOARD, &["--readings"]) {
        Ok(Outcome::Ok(_)) => Outcome::Ok(format!("the program of {BOARD} on samples")),
        Ok(outcome) | Err(outcome) => outcome,
    }
}

/// Mutation test of the proofs: changes bytes of a board's program, and checks that the proof refutes each change.
pub fn mutants(board: &str, part: &str) -> Outcome {
    match checked(board, &["--mutants", "--only", part]) {
        Ok(Outcome::Ok(_)) => Outcome::Ok(format!(
            "every wrong change of the program of {board} refuted"
        )),
        Ok(outcome) | Err(outcome) => outcome,
    }
}

/// Prepares what the checker of machine code needs, runs the checker, and returns its outcome.
fn checked(board: &str, options: &[&str]) -> Result<Outcome, Outcome> {
    if !firmware::BOARDS.contains(&board) {
        return Err(Outcome::Usage(format!(
            "there is no board `{board}`; there are {}",
            firmware::BOARDS.join(", ")
        )));
    }
    let python = super::with_wheels("elf-venv", "proofs/elf/requirements.txt")?;
    let program = firmware::build(board)?;
    let functions = functions(&program)?;
    let trace = traced()?;
    let mut check = shell::program(&python);
    check
        .arg("proofs/elf/check.py")
        .args([&program, &functions, &trace])
        .args(options);
    Ok(shell::run(&mut check))
}

/// Writes a file that lists the program's functions by their paths in the source, since each compiler mangles names differently.
/// Returns the file's path.
fn functions(program: &Path) -> Result<PathBuf, Outcome> {
    let (lines, outcome) = inspect::ask(["functions".as_ref(), program.as_os_str()]);
    outcome.went_well()?;
    let path = shell::target("elf-functions.txt");
    let written = std::fs::write(&path, lines.join("\n") + "\n");
    written.map_err(|why| Outcome::Failed(format!("{}: {why}", path.display())))?;
    Ok(path)
}

/// Compares the specification of the control period's functions with the Rust code. It needs no firmware, and of the Python
/// packages only z3.
pub fn read(python: &Path) -> Outcome {
    match traced() {
        Ok(trace) => {
            let mut reads = shell::program(python);
            shell::run(reads.arg("proofs/elf/traced.py").arg(trace))
        }
        Err(outcome) => outcome,
    }
}

/// Records control periods computed by the Rust code in a file, and returns the file's path.
fn traced() -> Result<PathBuf, Outcome> {
    let mut command = shell::cargo_locked("run");
    // Uses the same build profile as `cargo xtask prove --every`, so that the code is compiled only once.
    command.args(["--profile", "every", "-q", "-p", "touchstone-proofs"]);
    command.args(["--example", "trace", "--", TICKS]);
    let path = shell::target("elf-trace.txt");
    let written = std::fs::File::create(&path).and_then(|file| command.stdout(file).status());
    match written {
        Ok(status) if status.success() => Ok(path),
        Ok(_) => Err(Outcome::Failed("the example `trace` failed".into())),
        Err(why) => Err(Outcome::Failed(format!("the example `trace`: {why}"))),
    }
}
