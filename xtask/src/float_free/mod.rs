//! `cargo xtask float-free`: the control crate, as firmware builds it, has no float in it.
//!
//! Three looks, each finding what the others cannot: at the source (types, literals, casts, outside what the feature
//! `float` turns on); at the code that this machine's compiler makes of `control/examples/every_law.rs`, with all that it
//! calls in other crates; and, where the compiler can make it, at the microcontroller's code, where a soft-float target
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

pub fn run(args: &[String]) -> Outcome {
    if !args.is_empty() {
        return Outcome::Usage("cargo xtask float-free".into());
    }
    let (mut notes, mut failures) = (Vec::new(), Vec::new());
    for look in [in_source, in_host_code, in_thumb_code] {
        match look() {
            Outcome::Ok(note) => notes.push(note),
            Outcome::NotRun(reason) => notes.push(format!("not run: {reason}")),
            Outcome::Failed(reason) | Outcome::Usage(reason) => failures.push(reason),
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

fn in_source() -> Outcome {
    let folder = shell::root().join("control/src");
    match source::floats_below(&folder) {
        Ok(scan) if scan.findings.is_empty() => {
            Outcome::Ok(format!("source: {} files", scan.files))
        }
        Ok(scan) => failed("source", "floats", &scan.findings),
        Err(error) => Outcome::Failed(error),
    }
}

fn in_host_code() -> Outcome {
    let architecture = std::env::consts::ARCH;
    let Some(is_float) = assembly::float_operation(architecture) else {
        return Outcome::NotRun(format!("no list of float instructions of {architecture}"));
    };
    let folder = shell::target("float-free/host");
    let outcome = emit(shell::cargo_locked("build"), &[], &folder);
    if outcome.is_failure() {
        return outcome;
    }
    look(&folder.join("release"), architecture, is_float)
}

fn in_thumb_code() -> Outcome {
    let Some(compiler) = thumb::find() else {
        return Outcome::NotRun(format!(
            "no compiler for {0} (rustup target add {0})",
            thumb::TARGET
        ));
    };
    println!("with {compiler}");
    let folder = shell::target("float-free/thumb");
    let (cargo, options) = compiler.cargo();
    let outcome = emit(cargo, &options, &folder);
    if outcome.is_failure() {
        return outcome;
    }
    let code = folder.join(thumb::TARGET).join("release");
    look(&code, thumb::TARGET, assembly::is_thumb_float)
}

/// Builds the example for firmware's eyes, with the assembly of all its crates.
fn emit(mut cargo: std::process::Command, options: &[String], folder: &Path) -> Outcome {
    cargo
        .args(["--quiet", "--release", "--package", "touchstone-control"])
        .args(["--example", "every_law", "--target-dir"])
        .arg(folder)
        .args(options)
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .env("RUSTFLAGS", "--emit=asm -Ccodegen-units=1")
        // Bitcode for a later link would be empty of instructions.
        .env("CARGO_PROFILE_RELEASE_LTO", "off")
        .env("CARGO_PROFILE_RELEASE_DEBUG", "false");
    shell::run(&mut cargo)
}

/// Follows every function of the two crates through all that it calls.
fn look(release: &Path, name: &str, is_float: fn(&str) -> bool) -> Outcome {
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
        if stem.starts_with("every_law-") {
            example.extend(labels.iter().cloned());
        }
        if stem.starts_with("every_law-") || stem.starts_with("touchstone_control-") {
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
