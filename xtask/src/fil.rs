//! `cargo xtask fil [--sample | --brief | --only TEXT] [--board BOARD]`: firmware-in-the-loop tests. The firmware of all boards, or
//! of one, runs on an emulated chip with a simulated motor and hand.
//!
//! The checks are boot, calibration, arming, a press that must equal the control law on this machine bit for bit, and every
//! injected fault. They are printed as a table; one failed check fails the step. Except with `--only`, the emulator's own tests run
//! first. Afterwards the reference board runs one press of the scorecard (scripted actions of a simulated hand).
//!
//! `--sample` runs every third fault injection and at least one for each fault code. It runs all but the longest check on the
//! reference board, and few checks on the other boards. `--brief` runs the same injections and only the short checks.
//!
//! `--sabotage` shows that the checks fail where they must ([`sabotage`]). `--scorecard` runs the whole scorecard on the reference
//! board ([`board_scorecard`]).

use crate::firmware::{self, BOARDS, REFERENCE};
use crate::outcome::Outcome;
use crate::step::Share;
use crate::{board_scorecard, emulator, sabotage};

const SAMPLE: &str = "--sample";
const BRIEF: &str = "--brief";
/// The part of the firmware-in-the-loop tests that the middle gate (`cargo xtask test`) runs.
pub const ONE_BOARD: Share = Share::Part(
    &[BRIEF, "--board", REFERENCE],
    "two of three injections; the checks of starts, power cuts, heat, noise, cogging and eccentricity; the other four boards, and with them \
     whether every fault code is latched",
);
/// The part of the firmware-in-the-loop tests that the full gate (`cargo xtask test --full`) runs.
pub const SAMPLED: Share = Share::Part(
    &[SAMPLE],
    "some two of three injections (every fault code has one) and the map of the cogging; most checks of the boards that are not the reference",
);

pub fn run(args: &[String]) -> Outcome {
    let words: Vec<&str> = args.iter().map(String::as_str).collect();
    let (words, boards) = match words.as_slice() {
        [words @ .., "--board", name] if BOARDS.contains(name) => (words, vec![*name]),
        words => (words, BOARDS.to_vec()),
    };
    match words {
        [] | [SAMPLE | BRIEF] => with_a_press(words, &boards),
        ["--only", _] => emulator::call("fil", &boards, words),
        ["--scorecard"] => board_scorecard::run(true),
        ["--scorecard", "press"] => board_scorecard::run(false),
        ["--sabotage", rest @ ..] => sabotage::run(rest),
        _ => Outcome::Usage(format!(
            "cargo xtask fil [--sample | --brief | --only TEXT] [--board {}] | --scorecard [press] | --sabotage [--only TEXT]",
            firmware::BOARDS.join("|")
        )),
    }
}

/// Runs the emulator's own tests, then the firmware-in-the-loop checks with the options `words`, then one press of the scorecard
/// (scripted actions of a simulated hand).
fn with_a_press(words: &[&str], boards: &[&str]) -> Outcome {
    match emulator::test() {
        Outcome::Ok(_) => {}
        other => return other,
    }
    match emulator::call("fil", boards, words) {
        Outcome::Ok(rows) => match board_scorecard::run(false) {
            Outcome::Ok(card) => {
                Outcome::Ok(format!("{rows}; a press on the reference board: {card}"))
            }
            other => other,
        },
        other => other,
    }
}
