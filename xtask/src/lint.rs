//! `cargo xtask lint [--workspace]`: runs Clippy on every crate and target, with warnings as errors.

use crate::outcome::Outcome;
use crate::step::Gates;
use crate::{packages, shell};

/// Option that leaves out the crates for a debug probe, whose dependencies outnumber all others.
const WORKSPACE: &str = "--workspace";
pub const GATES: Gates = Gates::part(&[WORKSPACE], "the probe's crate with its feature");

pub fn run(args: &[String]) -> Outcome {
    let is_whole = match args {
        [] => true,
        [option] if option == WORKSPACE => false,
        _ => return Outcome::Usage("cargo xtask lint [--workspace]".into()),
    };
    if let Some(missing) = packages::missing_component("clippy") {
        return missing;
    }
    // Checks the control crate also alone: in the workspace it is built with the feature `float`, which firmware leaves out.
    let mut packages: Vec<&[&str]> = vec![&["--workspace"], &["--package", "touchstone-control"]];
    if is_whole {
        // Without its feature the probe's crate is empty. `cargo xtask probe` checks the program with that feature.
        packages.push(&["--package", "touchstone-probe", "--features", "probe-rs"]);
    }
    shell::run_all(packages.into_iter().map(|packages| {
        let mut command = shell::cargo_locked("clippy");
        command
            .args(packages)
            .args(["--all-targets", "--", "-D", "warnings"]);
        command
    }))
}
