//! `cargo xtask lint`: clippy on every crate and target, warnings denied.

use crate::outcome::Outcome;
use crate::{packages, shell};

pub fn run(_: &[String]) -> Outcome {
    if let Some(missing) = packages::missing_component("clippy") {
        return missing;
    }
    // Two once more by themselves. The control crate: in the workspace it is built with `float`, which firmware leaves out. What a probe
    // needs: without its feature it is empty. The program with that feature is looked at by `cargo xtask probe`.
    let packages: [&[&str]; 3] = [
        &["--workspace"],
        &["--package", "touchstone-control"],
        &["--package", "touchstone-probe", "--features", "probe-rs"],
    ];
    shell::run_all(packages.map(|packages| {
        let mut command = shell::cargo_locked("clippy");
        command
            .args(packages)
            .args(["--all-targets", "--", "-D", "warnings"]);
        command
    }))
}
