//! Calls the crate `inspect/`, which reads files written by builds, emulators and the model checker. The crate is built when a step
//! first needs it, so that other steps start without its dependencies.

use std::ffi::OsStr;
use std::process::{Command, Stdio};

use crate::outcome::Outcome;
use crate::{shell, unit};

/// A cargo command for the crate `inspect/`, with the profile that compiles fastest.
fn of_tools(what: &str) -> Command {
    let mut cargo = shell::cargo_locked(what);
    cargo.args([
        "--quiet",
        "--profile",
        "tools",
        "--package",
        "xtask-inspect",
    ]);
    cargo
}

/// The command that runs the crate `inspect/`. After the unit tests it is the program that they built for a test of that crate, so
/// that its dependencies are not compiled in a second profile.
fn program() -> Command {
    let built = shell::target("debug").join("xtask-inspect");
    if unit::has_compiled() && built.is_file() {
        return shell::program(built);
    }
    let mut cargo = of_tools("run");
    cargo.arg("--");
    cargo
}

/// Builds the crate `inspect/` early, so that a step that calls it at its end does not wait. Errors are ignored: the later call
/// reports them.
pub fn build() {
    let _ = of_tools("build").stderr(Stdio::null()).status();
}

/// Runs the crate `inspect/` with these arguments and prints its lines. The text of the outcome is the last line.
pub fn call<W: AsRef<OsStr>>(words: impl IntoIterator<Item = W>) -> Outcome {
    let (lines, outcome) = ask(words);
    for line in lines {
        println!("{line}");
    }
    outcome
}

/// Runs the crate `inspect/` like [`call`], but returns the lines instead of printing them.
pub fn ask<W: AsRef<OsStr>>(words: impl IntoIterator<Item = W>) -> (Vec<String>, Outcome) {
    let mut program = program();
    let done = program
        .args(words)
        .stdin(Stdio::null())
        .stderr(Stdio::inherit())
        .output();
    let done = match done {
        Ok(done) => done,
        Err(why) => return (Vec::new(), Outcome::Failed(format!("cargo: {why}"))),
    };
    let text = String::from_utf8_lossy(&done.stdout).into_owned();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let answer = done
        .status
        .code()
        .and_then(Outcome::of_code)
        .zip(lines.pop());
    let outcome = match answer {
        Some((of, sentence)) => of(sentence),
        None => Outcome::Failed(format!("`{}` failed", shell::shown(&program))),
    };
    (lines, outcome)
}
