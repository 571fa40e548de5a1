//! `cargo xtask page`: the live page and the board's in a real browser, driven by a script.

use crate::outcome::Outcome;
use crate::shell;

pub fn run(args: &[String]) -> Outcome {
    if args.len() > 2
        || args
            .first()
            .is_some_and(|seconds| seconds.parse::<f64>().is_err())
    {
        return Outcome::Usage("cargo xtask page [SECONDS [FOLDER]]".into());
    }
    if shell::capture(shell::program("python3").arg("--version")).is_none() {
        return Outcome::NotRun("no python3".into());
    }
    let built = shell::run(shell::cargo_locked("build").args(["--package", "touchstone"]));
    if built.is_failure() {
        return built;
    }
    let example = [
        "--package",
        "touchstone-tests",
        "--example",
        "knob_on_a_socket",
    ];
    let built = shell::run(shell::cargo_locked("build").args(example));
    if built.is_failure() {
        return built;
    }
    let made = shell::target("debug");
    let (program, knob) = (
        made.join("touchstone"),
        made.join("examples/knob_on_a_socket"),
    );
    let mut script = shell::program("python3");
    script.arg("tests/page/drive.py").args([program, knob]);
    script.args(args);
    let mut last = String::new();
    match shell::exit_code(&mut script, |line| last = line.to_owned()) {
        Ok(Some(code)) => Outcome::of_code(code).map_or_else(
            || Outcome::Failed(last.clone()),
            |outcome| outcome(last.clone()),
        ),
        Ok(None) => Outcome::Failed("the script was stopped".into()),
        Err(error) => Outcome::Failed(error.to_string()),
    }
}
