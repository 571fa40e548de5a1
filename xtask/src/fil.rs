//! `cargo xtask fil [--sample | --brief | --only TEXT] [--board BOARD]`: the firmware in the loop. The real programs of all boards, or of one, on an
//! emulated chip with a simulated motor and hand: boot, calibration, arming, the thesis' press compared with the law on this machine to the
//! bit, and every fault, injected. A table; one that is wrong fails all. `--sabotage`: that rows do go wrong, [`sabotage`]. `--scorecard`: what
//! a hand feels of the reference board, [`board_scorecard`]. A press of it is in the run of everything and in that of
//! the sample, which has one injection of three, all but the longest check on the reference board, and few checks on the others; the brief run
//! has the same injections, and the checks that are done soon.

use crate::firmware::{self, BOARDS, REFERENCE};
use crate::outcome::Outcome;
use crate::step::Share;
use crate::{board_scorecard, emulator, sabotage};

const SAMPLE: &str = "--sample";
const BRIEF: &str = "--brief";
/// The part that the first gate runs.
pub const ONE_BOARD: Share = Share::Part(
    &[BRIEF, "--board", REFERENCE],
    "two of three injections; the checks of starts, power cuts, heat, noise, cogging and eccentricity; the other four boards, and with them \
     whether every fault code is latched",
);
/// The part that the full gate runs.
pub const SAMPLED: Share = Share::Part(
    &[SAMPLE],
    "two of three injections and the map of the cogging; most checks of the boards that are not the reference",
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

/// The emulator's tests, everything or a sample, a press.
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
