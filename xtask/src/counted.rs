//! Counts the instructions of an example program with valgrind.

use std::path::PathBuf;

use crate::outcome::Outcome;
use crate::shell;

/// Reads the total number of executed instructions from the text of callgrind's output file.
pub fn instructions(file: &str) -> Option<u64> {
    let value = |key| {
        file.lines()
            .find_map(|line: &str| line.strip_prefix(key)?.trim().parse().ok())
    };
    value("totals:").or_else(|| value("summary:"))
}

/// Instructions per tick from a short and a long run: difference of the counted instructions, divided by the difference of the
/// ticks.
pub fn per_tick(ticks: [u64; 2], counted: [u64; 2]) -> f64 {
    (counted[1] as f64 - counted[0] as f64) / (ticks[1] - ticks[0]) as f64
}

/// Builds an example of `host-sim/sim` and returns its path. It is optimised across crates like the released program, so that a
/// count does not depend on the crate in which a function is.
pub fn built(example: &str) -> Result<PathBuf, Outcome> {
    let mut build = shell::cargo_locked("build");
    build.args(["--profile", "dist", "--package", "touchstone-sim"]);
    // Callgrind finds the function `mark` by its name, so the names must not be stripped as in the released program.
    build.args(["--config", "profile.dist.strip=false"]);
    build.arg("--example");
    let built = shell::run(build.arg(example));
    if built.is_failure() {
        return Err(built);
    }
    Ok(shell::target("dist/examples").join(example))
}
