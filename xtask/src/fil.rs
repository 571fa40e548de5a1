//! `cargo xtask fil [--only TEXT]`: the firmware in the loop. The real programs of all boards, on an emulated chip with a
//! simulated motor and hand: boot, calibration, arming, the thesis' press compared with the law on this machine to the bit, and
//! every fault, injected. A table; one that is wrong fails all. `--sabotage`: that rows do go wrong, [`sabotage`].

use crate::emulator;
use crate::outcome::Outcome;
use crate::sabotage;

pub fn run(args: &[String]) -> Outcome {
    match args {
        [] => match emulator::test() {
            Outcome::Ok(_) => emulator::call("fil", &[]),
            other => other,
        },
        [option, _] if option == "--only" => emulator::call("fil", args),
        [option, rest @ ..] if option == "--sabotage" => sabotage::run(rest),
        _ => Outcome::Usage("cargo xtask fil [--only TEXT] | --sabotage [--only TEXT]".into()),
    }
}
