//! `cargo xtask page`: the live pages and the board's in real browsers, driven by a script.

use std::path::PathBuf;

use crate::outcome::Outcome;
use crate::{emulator, shell};

/// The board whose firmware is emulated before the page.
const BOARD: &str = "nucleo-g474re";

pub fn run(args: &[String]) -> Outcome {
    if args.len() > 2
        || args
            .first()
            .is_some_and(|seconds| seconds.parse::<f64>().is_err())
    {
        return Outcome::Usage("cargo xtask page [SECONDS [FOLDER]]".into());
    }
    if shell::capture(shell::program("python3").arg("--version")).is_none() {
        return Outcome::NotRun("no python3".into());
    }
    let made = match shell::built_with_tests() {
        Ok(folder) => folder,
        Err(outcome) => return outcome,
    };
    let (program, knob) = (
        made.join("touchstone"),
        made.join("examples").join(shell::KNOB),
    );
    let mut script = shell::program("python3");
    // Without an emulator the pages are still driven, before the simulated knob.
    let (emulated, firmware) = match emulator::firmware_and_emulator(&[BOARD]) {
        Ok((emulated, programs)) => (emulated, programs.into_iter().next().unwrap_or_default()),
        Err(Outcome::NotRun(_)) => (PathBuf::from("-"), PathBuf::from("-")),
        Err(outcome) => return outcome,
    };
    script
        .arg("tests/page/drive.py")
        .args([program, knob, emulated, firmware]);
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
