//! `cargo xtask doc`: the documentation of all crates builds without a warning, broken links included.

use crate::outcome::Outcome;
use crate::shell;

pub fn run(_: &[String]) -> Outcome {
    let mut command = shell::cargo_locked("doc");
    command
        .args(["--workspace", "--no-deps"])
        .env("RUSTDOCFLAGS", "-D warnings");
    shell::run(&mut command)
}
