//! `cargo xtask cycles`: prints instructions, estimated processor cycles (from a table) and stack depth of control law, control
//! interrupt and current loop. The firmware of all boards runs in the emulator. The printed values are the worst over presses, taps
//! and extreme settings.

use crate::emulator;
use crate::firmware::BOARDS;
use crate::outcome::Outcome;

pub fn run(args: &[String]) -> Outcome {
    match args {
        [] => emulator::call("cycles", &BOARDS, &[]),
        _ => Outcome::Usage("cargo xtask cycles".into()),
    }
}
