//! `cargo xtask lint`: clippy on every crate and target, warnings denied.

use crate::outcome::Outcome;
use crate::{packages, shell};

pub fn run(_: &[String]) -> Outcome {
    if let Some(missing) = packages::missing_component("clippy") {
        return missing;
    }
    // The control crate once more by itself: in the workspace it is built with `float`, which firmware leaves out.
    let packages: [&[&str]; 2] = [&["--workspace"], &["--package", "touchstone-control"]];
    shell::run_all(packages.map(|packages| {
        let mut command = shell::cargo_locked("clippy");
        command
            .args(packages)
            .args(["--all-targets", "--", "-D", "warnings"]);
        command
    }))
}
