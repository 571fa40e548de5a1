//! `cargo xtask page [--short | SECONDS [FOLDER]]`: tests the web pages of simulator and board in real browsers, which a script
//! controls.

use std::path::PathBuf;

use crate::outcome::Outcome;
use crate::step::Share;
use crate::{emulator, shell};

/// The board whose firmware runs in the emulator while a browser tests the board's page.
const BOARD: &str = "nucleo-g474re";

/// Option for a short test: one browser, no emulated firmware, few seconds of real time.
const SHORT: &str = "--short";
/// The part of `cargo xtask page` that the middle gate (`cargo xtask test`) runs.
pub const SHORT_RUN: Share = Share::Part(
    &[SHORT],
    "the second browser; the emulated firmware's board path; 15 of 20 s of real time",
);

pub fn run(args: &[String]) -> Outcome {
    let is_short = args == [SHORT];
    let seconds = args.first().map(|seconds| seconds.parse::<f64>());
    if !is_short && (args.len() > 2 || seconds.is_some_and(|seconds| seconds.is_err())) {
        return Outcome::Usage("cargo xtask page [--short | SECONDS [FOLDER]]".into());
    }
    if shell::capture(shell::program("python3").arg("--version")).is_none() {
        return Outcome::NotRun("no python3".into());
    }
    let made = match shell::built_with_tests() {
        Ok(folder) => folder,
        Err(outcome) => return outcome,
    };
    let program = made.join("touchstone");
    let mut script = shell::program("python3");
    // Without an emulator the script still tests the pages with a simulated knob.
    let nowhere = || (PathBuf::from("-"), PathBuf::from("-"));
    let (emulated, firmware) = if is_short {
        nowhere()
    } else {
        match emulator::firmware_and_emulator(&[BOARD]) {
            Ok((emulated, programs)) => (emulated, programs.into_iter().next().unwrap_or_default()),
            Err(Outcome::NotRun(_)) => nowhere(),
            Err(outcome) => return outcome,
        }
    };
    script
        .arg("tests/page/drive.py")
        .args([program, emulated, firmware]);
    script.args(args);
    let mut last = String::new();
    match shell::exit_code(&mut script, |line| last = line.to_owned()) {
        Ok(Some(code)) => Outcome::of_code(code).map_or_else(
            || Outcome::Failed(last.clone()),
            |outcome| outcome(last.clone()),
        ),
        Ok(None) => Outcome::Failed("the script was stopped".into()),
        Err(error) => Outcome::Failed(error.to_string()),
    }
}
