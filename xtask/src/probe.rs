//! `cargo xtask probe`: boards behind a probe by the crate probe-rs. No other step builds that: clippy, the tests on a chip in software,
//! and those of the program with the crate inside, all of them, as it is handed out so: one of the crate's own packages changes how
//! `serde_json` keeps numbers, in the whole program.

use crate::outcome::Outcome;
use crate::{packages, shell};

const USAGE: &str = "cargo xtask probe";

/// What turns it on, for the program and for the crate by itself.
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
