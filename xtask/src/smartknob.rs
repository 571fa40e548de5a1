//! `cargo xtask smartknob`: a program for a SmartKnob before a board's firmware. The test's client, `touchstone bridge`, its pseudo
//! terminal and the unmodified firmware in the emulator work together, as the client and a board would.

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
        // A test that was renamed must not go unnoticed.
        Outcome::Ok(_) if seen == 0 => Outcome::Failed("no test was run".into()),
        Outcome::Ok(_) => Outcome::Ok(format!(
            "configured, turned and read through the pseudo terminal, on {BOARD}"
        )),
        failed => failed,
    }
}
