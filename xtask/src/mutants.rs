//! `cargo xtask prove --mutants`: small wrong changes to the law, each of which a named proof must refute.

use std::path::Path;
use std::process::{Command, ExitCode};

const LIST: &str = "proofs/mutants.toml";
const SCRATCH: &str = "target/mutants";

/// One `[[mutant]]`: plain `key = "value"` lines.
#[derive(Debug, Default, Clone)]
struct Mutant {
    file: String,
    find: String,
    replace: String,
    harness: String,
}

fn list() -> Vec<Mutant> {
    let text = std::fs::read_to_string(LIST).unwrap_or_default();
    let mut mutants: Vec<Mutant> = Vec::new();
    for line in text.lines() {
        if line.trim() == "[[mutant]]" {
            mutants.push(Mutant::default());
        }
        let Some((key, value)) = line.split_once(" = '") else {
            continue;
        };
        let (Some(mutant), Some(value)) = (mutants.last_mut(), value.strip_suffix('\'')) else {
            continue;
        };
        match key {
            "file" => mutant.file = value.into(),
            "find" => mutant.find = value.into(),
            "replace" => mutant.replace = value.into(),
            "harness" => mutant.harness = value.into(),
            _ => {}
        }
    }
    mutants
}

/// Copies what the proofs are made of, changes one thing at a time, and expects the named harness to refute it.
pub fn run() -> ExitCode {
    let scratch = Path::new(SCRATCH);
    let _ = std::fs::remove_dir_all(scratch.join("work"));
    let work = scratch.join("work");
    if std::fs::create_dir_all(&work).is_err() {
        eprintln!("mutants: cannot write to {SCRATCH}");
        return ExitCode::FAILURE;
    }
    for part in ["control", "protocol", "proofs", "Cargo.lock"] {
        let _ = Command::new("cp").args(["-r", part]).arg(&work).status();
    }
    // Only the proved crates: nothing else has to build.
    let manifest = std::fs::read_to_string("Cargo.toml").unwrap_or_default();
    let manifest: String = manifest
        .lines()
        .filter(|line| !line.starts_with("default-members"))
        .map(|line| {
            if line.starts_with("members") {
                "members = [\"control\", \"protocol\", \"proofs\"]"
            } else {
                line
            }
        })
        .filter(|line| !line.starts_with("touchstone = "))
        .fold(String::new(), |text, line| text + line + "\n");
    let _ = std::fs::write(work.join("Cargo.toml"), manifest);
    let target = std::env::current_dir()
        .unwrap_or_default()
        .join(scratch)
        .join("target");

    let mutants = list();
    let mut caught = 0;
    for (number, mutant) in mutants.iter().enumerate() {
        let path = work.join(&mutant.file);
        let source = std::fs::read_to_string(&path).unwrap_or_default();
        let verdict = if source.matches(&mutant.find).count() != 1 {
            "does not apply exactly once"
        } else {
            let _ = std::fs::write(&path, source.replace(&mutant.find, &mutant.replace));
            let verdict = match crate::prove::refutes(&work, &target, &mutant.harness) {
                Some(true) => "caught",
                Some(false) => "MISSED",
                None => "no answer",
            };
            let _ = std::fs::write(&path, source);
            verdict
        };
        caught += usize::from(verdict == "caught");
        println!(
            "{:>3} {verdict:<10} {}  `{}` -> `{}`",
            number + 1,
            mutant.harness,
            mutant.find,
            mutant.replace
        );
    }
    println!("{caught} of {} mutants caught by a proof", mutants.len());
    if !mutants.is_empty() && caught * 100 >= mutants.len() * 95 {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
