//! `cargo xtask cycles`: instructions and table cycles of the law, the control interrupt and the current loop, on the real programs
//! of all boards in the emulator, worst over presses, taps and hard settings; and how deep the stack was.

use crate::emulator;
use crate::firmware::BOARDS;
use crate::outcome::Outcome;

pub fn run(args: &[String]) -> Outcome {
    match args {
        [] => emulator::call("cycles", &BOARDS, &[]),
        _ => Outcome::Usage("cargo xtask cycles".into()),
    }
}
