//! `cargo xtask schema`: checks that the program's output fits the documented JSON schema, with an independent validator in Python.

use std::process::Command;

use crate::outcome::Outcome;
use crate::shell;

pub fn run(_: &[String]) -> Outcome {
    let found = Command::new("python3")
        .args(["-c", "import jsonschema"])
        .output()
        .is_ok_and(|output| output.status.success());
    if !found {
        return Outcome::NotRun("python3 has no jsonschema; `pip install jsonschema`".to_owned());
    }
    // The whole workspace is built, with the same features as in `cargo xtask unit`.
    let mut command = shell::cargo_locked("test");
    command
        .args(["--workspace", "--test", "cli"])
        .args(["--", "--ignored", "cli_folder::"]);
    shell::run(&mut command)
}
