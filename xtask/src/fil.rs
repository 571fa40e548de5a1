//! `cargo xtask fil [--only TEXT]`: the firmware in the loop. The real program of the board, on an emulated chip with a simulated
//! motor and hand: boot, calibration, arming, the thesis' press compared with the law on this machine to the bit, and every
//! fault, injected. A table; one that is wrong fails all.

use crate::emulator;
use crate::outcome::Outcome;

pub fn run(args: &[String]) -> Outcome {
    match args {
        [] => match emulator::test() {
            Outcome::Ok(_) => emulator::call("fil", &[]),
            other => other,
        },
        [option, _] if option == "--only" => emulator::call("fil", args),
        _ => Outcome::Usage("cargo xtask fil [--only TEXT]".into()),
    }
}
