//! `cargo xtask probe`: boards behind a probe, by the crate probe-rs, which no other step builds. It runs clippy, the
//! tests on a simulated chip, and all tests of the program with the crate inside, as it is released. The last is
//! needed since one of the crate's packages changes how `serde_json` keeps numbers, in the whole program.

use crate::outcome::Outcome;
use crate::{packages, shell};

const USAGE: &str = "cargo xtask probe";

/// Features that switch it on, for the program and for the crate.
const FEATURES: &str = "touchstone/probe,touchstone-probe/probe-rs";

pub fn run(args: &[String]) -> Outcome {
    if !args.is_empty() {
        return Outcome::Usage(USAGE.into());
    }
    if let Some(missing) = packages::missing_component("clippy") {
        return missing;
    }
    let with = |subcommand: &str, packages: &[&str], rest: &[&str]| {
        let mut command = shell::cargo_locked(subcommand);
        for package in packages {
            command.args(["--package", package]);
        }
        command.args(rest);
        command
    };
    let (own, program) = ("touchstone-probe", "touchstone");
    shell::run_all([
        with(
            "clippy",
            &[own, program],
            &[
                "--features",
                FEATURES,
                "--all-targets",
                "--",
                "-D",
                "warnings",
            ],
        ),
        with("test", &[own], &["--features", "probe-rs"]),
        with(
            "test",
            &[program, "touchstone-lab"],
            &[
                "--features",
                "touchstone/probe",
                "--lib",
                "--bins",
                "--tests",
            ],
        ),
    ])
}
