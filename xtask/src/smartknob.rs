//! `cargo xtask smartknob`: tests that a program written for a SmartKnob works with a board's firmware. The test's client talks to
//! `touchstone bridge` through its pseudo terminal; the unmodified firmware runs in the emulator.

use crate::outcome::Outcome;
use crate::{emulator, shell};

const USAGE: &str = "cargo xtask smartknob";

/// The board whose firmware runs in the emulator.
const BOARD: &str = "nucleo-g474re";

pub fn run(args: &[String]) -> Outcome {
    if !args.is_empty() {
        return Outcome::Usage(USAGE.into());
    }
    if !cfg!(target_os = "linux") {
        return Outcome::NotRun("the test's client needs Linux".into());
    }
    let (emulator, programs) = match emulator::firmware_and_emulator(&[BOARD]) {
        Ok(built) => built,
        Err(outcome) => return outcome,
    };
    let mut seen = 0;
    let mut test = shell::cargo_locked("test");
    test.args(["--workspace", "--test", "device"])
        .args([
            "--",
            "--ignored",
            "emulated_firmware",
            "--test-threads",
            "1",
        ])
        .env("TOUCHSTONE_EMULATOR", emulator)
        .env(
            "TOUCHSTONE_EMULATED_FIRMWARE",
            programs.into_iter().next().unwrap_or_default(),
        );
    let outcome = shell::run_reading(&mut test, |line| {
        seen +=
            usize::from(line.starts_with("test ") && line.ends_with("emulated_firmware ... ok"));
    });
    match outcome {
        // No test has run: it was renamed, and the filter no longer fits its name.
        Outcome::Ok(_) if seen == 0 => Outcome::Failed("no test was run".into()),
        Outcome::Ok(_) => Outcome::Ok(format!(
            "configured, turned and read through the pseudo terminal, on {BOARD}"
        )),
        failed => failed,
    }
}
