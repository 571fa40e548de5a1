//! `cargo xtask fil [--sample | --only TEXT]`: the firmware in the loop. The real programs of all boards, on an emulated chip with a
//! simulated motor and hand: boot, calibration, arming, the thesis' press compared with the law on this machine to the bit, and
//! every fault, injected. A table; one that is wrong fails all. `--sabotage`: that rows do go wrong, [`sabotage`]. `--scorecard`: what a
//! hand feels of the reference board, [`board_scorecard`]; a press of it is in the run of everything and in that of
//! the sample, which has one injection of three, all but the longest check on the reference board, and few checks on the others.

use crate::outcome::Outcome;
use crate::{board_scorecard, emulator, sabotage};

/// What `cargo xtask test` gives it.
pub const SAMPLE: &str = "--sample";

pub fn run(args: &[String]) -> Outcome {
    match args {
        [] => with_a_press(args),
        [option] if option == SAMPLE => with_a_press(args),
        [option] if option == "--scorecard" => board_scorecard::run(true),
        [option, deed] if option == "--scorecard" && deed == "press" => board_scorecard::run(false),
        [option, _] if option == "--only" => emulator::call("fil", args),
        [option, rest @ ..] if option == "--sabotage" => sabotage::run(rest),
        _ => Outcome::Usage(
            "cargo xtask fil [--sample | --only TEXT] | --scorecard [press] | --sabotage [--only TEXT]".into(),
        ),
    }
}

/// The emulator's tests, everything or a sample, a press.
fn with_a_press(args: &[String]) -> Outcome {
    match emulator::test() {
        Outcome::Ok(_) => {}
        other => return other,
    }
    match emulator::call("fil", args) {
        Outcome::Ok(rows) => match board_scorecard::run(false) {
            Outcome::Ok(card) => {
                Outcome::Ok(format!("{rows}; a press on the reference board: {card}"))
            }
            other => other,
        },
        other => other,
    }
}
