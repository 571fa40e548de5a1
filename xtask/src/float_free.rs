//! `cargo xtask float-free [--source]`: checks that the crates with control law, guard and motor drive, as built for firmware, use
//! no floating point.
//!
//! Three checks find different faults:
//! - in the source: float types, literals and casts outside the parts that the feature `float` enables;
//! - in the code compiled for this machine: float operations in an example that uses all that the firmware uses, and in every function
//!   that the example calls in other crates;
//! - in the code compiled for the microcontroller, if an installed compiler supports it: calls that stand for float operations,
//!   since a soft-float target has no float instructions.
//!
//! The two checks of compiled code also find calls to panics, of which set-up and control periods must have none.

use std::path::{Path, PathBuf};

use crate::outcome::Outcome;
use crate::step::Gates;
use crate::{inspect, shell, toolchain};

/// A crate to check, with the example that calls all that the firmware calls.
struct Subject {
    package: &'static str,
    /// Folder of the crate's source.
    folder: &'static str,
    example: &'static str,
    /// Beginning of the name of the crate's assembly file.
    assembly: &'static str,
}

const SUBJECTS: [Subject; 2] = [
    Subject {
        package: "touchstone-control",
        folder: "control/src",
        example: "every_law",
        assembly: "touchstone_control-",
    },
    Subject {
        package: "touchstone-drive",
        folder: "drive/src",
        example: "both_interrupts",
        assembly: "touchstone_drive-",
    },
];

/// Option that checks only the source; `cargo xtask test` without `--full` uses it.
const SOURCE: &str = "--source";
pub const GATES: Gates = Gates::part(
    &[SOURCE],
    "the look at the code, for this machine and the microcontroller",
);

pub fn run(args: &[String]) -> Outcome {
    let looks: &[fn(&Subject) -> Outcome] = match args {
        [] => &[in_source, in_host_code, in_thumb_code],
        [only] if only == SOURCE => &[in_source],
        _ => return Outcome::Usage("cargo xtask float-free [--source]".into()),
    };
    let (mut notes, mut failures) = (Vec::new(), Vec::new());
    for subject in &SUBJECTS {
        for look in looks {
            match look(subject) {
                Outcome::Ok(note) => notes.push(format!("{} {note}", subject.package)),
                Outcome::NotRun(reason) => notes.push(format!("not run: {reason}")),
                Outcome::Failed(reason) | Outcome::Usage(reason) => {
                    failures.push(format!("{}: {reason}", subject.package));
                }
            }
        }
    }
    if failures.is_empty() {
        Outcome::Ok(notes.join("; "))
    } else {
        Outcome::Failed(failures.join("; "))
    }
}

fn in_source(subject: &Subject) -> Outcome {
    inspect::call([
        "float-source".as_ref(),
        shell::root().join(subject.folder).as_os_str(),
    ])
}

fn in_host_code(subject: &Subject) -> Outcome {
    let folder = folder("host", &toolchain::active_version());
    let outcome = emit(subject, shell::cargo_locked("build"), &[], &folder);
    if outcome.is_failure() {
        return outcome;
    }
    look(subject, &folder.join("release"), std::env::consts::ARCH)
}

fn in_thumb_code(subject: &Subject) -> Outcome {
    let target = toolchain::SOFT_FLOAT;
    let compiler = match toolchain::obtain(target) {
        Ok(compiler) => compiler,
        Err(outcome) => return outcome,
    };
    println!("with {compiler}");
    let folder = folder("thumb", &compiler.version);
    let (cargo, options) = compiler.cargo(&["core"]);
    let outcome = emit(subject, cargo, &options, &folder);
    if outcome.is_failure() {
        return outcome;
    }
    look(subject, &folder.join(target).join("release"), target)
}

/// Folder for builds with one compiler and version, so that code of different compilers is never mixed.
fn folder(name: &str, version: &str) -> PathBuf {
    shell::target("float-free").join(format!("{name}-{version}"))
}

/// Builds the example as firmware would build it, and writes the assembly of all its crates.
fn emit(
    subject: &Subject,
    mut cargo: std::process::Command,
    options: &[String],
    folder: &Path,
) -> Outcome {
    cargo
        .args(["--quiet", "--release", "--package", subject.package])
        .args(["--example", subject.example, "--target-dir"])
        .arg(folder)
        .args(options)
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env("RUSTFLAGS", "--emit=asm -Ccodegen-units=1")
        // With link-time optimisation the assembly files would hold bitcode instead of instructions.
        .env("CARGO_PROFILE_RELEASE_LTO", "off")
        .env("CARGO_PROFILE_RELEASE_DEBUG", "false");
    shell::run(&mut cargo)
}

/// Searches the assembly of a crate and its example, and of every function that they call, for float operations and panics.
fn look(subject: &Subject, release: &Path, architecture: &str) -> Outcome {
    inspect::call([
        "float-code".as_ref(),
        architecture.as_ref(),
        release.as_os_str(),
        subject.assembly.as_ref(),
        subject.example.as_ref(),
    ])
}
