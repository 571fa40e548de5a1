//! `cargo xtask float-free`: the crates that decide, as firmware builds them, have no float in them.
//!
//! Three looks, each finding what the others cannot: at the source (types, literals, casts, outside what the feature
//! `float` turns on); at the code that this machine's compiler makes of an example that uses all that firmware uses, with all
//! that it calls in other crates; and, where the compiler can make it, at the microcontroller's code, where a soft-float target
//! turns every float operation into a call with a telling name. Where the code is looked at, calls to panics are found too:
//! set-up and tick must have none.

mod assembly;
mod source;
pub mod thumb;

use std::path::{Path, PathBuf};

use crate::outcome::Outcome;
use crate::shell;

/// How many findings are printed before the rest is only counted.
const SHOWN: usize = 20;

/// A crate and the example that stands for firmware.
struct Subject {
    package: &'static str,
    /// Its source.
    folder: &'static str,
    example: &'static str,
    /// Its assembly, by the beginning of the file's name.
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

pub fn run(args: &[String]) -> Outcome {
    if !args.is_empty() {
        return Outcome::Usage("cargo xtask float-free".into());
    }
    let (mut notes, mut failures) = (Vec::new(), Vec::new());
    for subject in &SUBJECTS {
        for look in [in_source, in_host_code, in_thumb_code] {
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

fn failed(place: &str, what: &str, findings: &[String]) -> Outcome {
    for finding in findings.iter().take(SHOWN) {
        println!("{finding}");
    }
    if findings.len() > SHOWN {
        println!("… and {} more", findings.len() - SHOWN);
    }
    Outcome::Failed(format!("{what} in the {place}: {}", findings.len()))
}

fn in_source(subject: &Subject) -> Outcome {
    let folder = shell::root().join(subject.folder);
    match source::floats_below(&folder) {
        Ok(scan) if scan.findings.is_empty() => {
            Outcome::Ok(format!("source: {} files", scan.files))
        }
        Ok(scan) => failed("source", "floats", &scan.findings),
        Err(error) => Outcome::Failed(error),
    }
}

fn in_host_code(subject: &Subject) -> Outcome {
    let architecture = std::env::consts::ARCH;
    let Some(is_float) = assembly::float_operation(architecture) else {
        return Outcome::NotRun(format!("no list of float instructions of {architecture}"));
    };
    let folder = folder("host", &thumb::active_version());
    let outcome = emit(subject, shell::cargo_locked("build"), &[], &folder);
    if outcome.is_failure() {
        return outcome;
    }
    look(subject, &folder.join("release"), architecture, is_float)
}

fn in_thumb_code(subject: &Subject) -> Outcome {
    let Some(compiler) = thumb::find() else {
        return Outcome::NotRun(format!(
            "no compiler for {0} (rustup target add {0})",
            thumb::TARGET
        ));
    };
    println!("with {compiler}");
    let folder = folder("thumb", &compiler.version);
    let (cargo, options) = compiler.cargo();
    let outcome = emit(subject, cargo, &options, &folder);
    if outcome.is_failure() {
        return outcome;
    }
    let code = folder.join(thumb::TARGET).join("release");
    look(subject, &code, thumb::TARGET, assembly::is_thumb_float)
}

/// One folder for each compiler: the code of two must not be mixed.
fn folder(name: &str, version: &str) -> PathBuf {
    shell::target("float-free").join(format!("{name}-{version}"))
}

/// Builds the example for firmware's eyes, with the assembly of all its crates.
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
        // Bitcode for a later link would be empty of instructions.
        .env("CARGO_PROFILE_RELEASE_LTO", "off")
        .env("CARGO_PROFILE_RELEASE_DEBUG", "false");
    shell::run(&mut cargo)
}

/// Follows every function of crate and example through all that it calls.
fn look(subject: &Subject, release: &Path, name: &str, is_float: fn(&str) -> bool) -> Outcome {
    let files = [release.join("deps"), release.join("examples")];
    let files: Vec<PathBuf> = files.iter().flat_map(|folder| newest(folder)).collect();
    let mut code = assembly::Code::default();
    let (mut all, mut example) = (Vec::new(), Vec::new());
    for file in &files {
        let Ok(text) = std::fs::read_to_string(file) else {
            return Outcome::Failed(format!("{}: cannot be read", file.display()));
        };
        let labels = code.add(&text);
        let stem = file.file_name().unwrap_or_default().to_string_lossy();
        let is_example = stem.starts_with(&format!("{}-", subject.example));
        if is_example {
            example.extend(labels.iter().cloned());
        }
        if is_example || stem.starts_with(subject.assembly) {
            all.extend(labels);
        }
    }
    let floats = code.scan(&all, is_float);
    // Texts for people may panic by their types, though never in fact; set-up and tick are not to have it in them at all.
    let panics = code.scan(&example, assembly::is_panic);
    if panics.instructions == 0 {
        return Outcome::Failed(format!("no code of {name} in {}", release.display()));
    }
    let place = format!("code for {name}");
    match (&floats.findings[..], &panics.findings[..]) {
        ([], []) => Outcome::Ok(format!(
            "{name}: {} functions, {} instructions",
            floats.functions, floats.instructions
        )),
        (floats @ [_, ..], _) => failed(&place, "floats", floats),
        ([], panics) => failed(&place, "panics", panics),
    }
}

/// The newest assembly of each crate in a folder: an older one is of an older source.
fn newest(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return Vec::new();
    };
    let mut found: Vec<_> = entries
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "s"))
        .filter_map(|path| {
            let written = path.metadata().ok()?.modified().ok()?;
            let stem = path.file_stem()?.to_string_lossy().into_owned();
            let krate = stem.rsplit_once('-')?.0.to_owned();
            Some((krate, std::cmp::Reverse(written), path))
        })
        .collect();
    found.sort();
    found.dedup_by(|later, first| later.0 == first.0);
    found.into_iter().map(|(_, _, path)| path).collect()
}
