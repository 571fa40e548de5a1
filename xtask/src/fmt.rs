//! `cargo xtask fmt`: checks that the code is formatted as rustfmt does by default.

use crate::outcome::Outcome;
use crate::{packages, shell};

pub fn run(args: &[String]) -> Outcome {
    if let Some(missing) = packages::missing_component("rustfmt") {
        return missing;
    }
    let mut command = shell::cargo("fmt");
    command.arg("--all");
    match args {
        [] => command.arg("--check"),
        [write] if write == "--write" => &mut command,
        _ => return Outcome::Usage("cargo xtask fmt [--write]".into()),
    };
    match shell::run(&mut command) {
        Outcome::Failed(_) => Outcome::Failed("`cargo xtask fmt --write` formats it".into()),
        other => other,
    }
}
