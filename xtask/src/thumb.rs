//! `cargo xtask thumb`: runs every control law on a Cortex-M4F that QEMU emulates.
//!
//! This machine and the emulated one (`tests/thumb`) both compute the test vectors of `tests/vectors`; all digests (hashes) of
//! their results must be equal. The emulated program also counts the instructions of each control period. The counts are exact, but
//! only for the periods that ran, and instructions are not cycles. Finally all code that a control period can reach must be free of
//! floats and panics.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::outcome::Outcome;
use crate::toolchain::{self, BOARD};
use crate::{inspect, packages, shell};

const QEMU: &str = "qemu-system-arm";

pub fn run(args: &[String]) -> Outcome {
    if !args.is_empty() {
        return Outcome::Usage("cargo xtask thumb".into());
    }
    match compare() {
        Ok(outcome) | Err(outcome) => outcome,
    }
}

fn compare() -> Result<Outcome, Outcome> {
    let (build, options) = toolchain::build_board()?;
    if !has_qemu() {
        packages::apt_get(&[QEMU]);
    }
    if !has_qemu() {
        return Err(Outcome::NotRun(format!("no QEMU (apt-get install {QEMU})")));
    }
    shell::run(&mut self::build(build, &options)).went_well()?;
    let program = shell::target("thumb")
        .join(BOARD)
        .join("release/touchstone-thumb");
    let mut golden = shell::cargo_locked("run");
    golden.args(["--quiet", "--release", "--package", "touchstone-vectors"]);
    let here = kept(golden.args(["--example", "golden"]), "desktop.txt")?;
    let there = kept(&mut qemu(&program), "microcontroller.txt")?;
    Ok(inspect::call([
        "thumb".as_ref(),
        program.as_os_str(),
        here.as_os_str(),
        there.as_os_str(),
    ]))
}

fn has_qemu() -> bool {
    shell::capture(shell::program(QEMU).arg("--version")).is_some()
}

/// The command that builds the program for the emulated microcontroller.
fn build(mut cargo: Command, options: &[String]) -> Command {
    cargo
        .args(["--quiet", "--release", "--manifest-path"])
        .args(["tests/thumb/Cargo.toml", "--target-dir"])
        .arg(shell::target("thumb"))
        .args(options);
    cargo
}

/// The same command for a build ahead of this step, if there is a compiler for it.
pub fn builds() -> Option<Command> {
    let (cargo, options) = toolchain::build_board().ok()?;
    Some(build(cargo, &options))
}

/// The QEMU command that runs the program. Every instruction takes 1024 ns of emulated time, so the program counts instructions by
/// reading the time.
fn qemu(program: &Path) -> Command {
    let mut qemu = shell::program(QEMU);
    qemu.args(["-M", "mps2-an386", "-icount", "shift=10", "-nographic"])
        .args(["-monitor", "none", "-serial", "none"])
        .args(["-semihosting-config", "enable=on,target=native", "-kernel"])
        .arg(program);
    qemu
}

/// Runs a command, stores its output in a file and returns the file's path. Prints the end of the output only if the command fails.
fn kept(command: &mut Command, name: &str) -> Result<PathBuf, Outcome> {
    println!("$ {}", shell::shown(command));
    let output = command
        .stdin(std::process::Stdio::null())
        .output()
        .map_err(|error| Outcome::Failed(error.to_string()))?;
    if output.status.success() {
        let path = shell::target("thumb").join(name);
        return match std::fs::write(&path, &output.stdout) {
            Ok(()) => Ok(path),
            Err(why) => Err(Outcome::Failed(format!("{}: {why}", path.display()))),
        };
    }
    let text = String::from_utf8_lossy(&output.stdout);
    let last: Vec<&str> = text.lines().rev().take(3).collect();
    println!(
        "{}{}",
        String::from_utf8_lossy(&output.stderr),
        last.join("\n")
    );
    Err(Outcome::Failed(format!(
        "`{}` failed",
        shell::shown(command)
    )))
}
