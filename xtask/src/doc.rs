//! `cargo xtask doc`: builds the documentation of all crates; any warning, also about a broken link, is an error.

use crate::outcome::Outcome;
use crate::shell;

pub fn run(_: &[String]) -> Outcome {
    let mut command = shell::cargo_locked("doc");
    command
        .args(["--workspace", "--no-deps"])
        .env("RUSTDOCFLAGS", "-D warnings");
    shell::run(&mut command)
}
