//! `cargo xtask probe`: tests the access to boards through a debug probe, which uses the crate probe-rs. Most other steps do not
//! build that crate.
//!
//! The step runs Clippy, the tests on a simulated chip, and all tests of the program built with probe-rs as in the release. The
//! program's tests are repeated because a dependency of probe-rs changes how `serde_json` stores numbers in the whole program.

use crate::outcome::Outcome;
use crate::{packages, shell};

const USAGE: &str = "cargo xtask probe";

/// Features that enable probe-rs in the program and in the crate for the probe.
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
