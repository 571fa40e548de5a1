//! `cargo xtask prove`: runs the proofs and believes only what it sees.
//!
//! The checker ends with 0 also when there was nothing to prove, when an assumption was impossible and when a cover was never
//! reached. So the gate reads its report: every harness of the committed list ran, no other did, each succeeded, each
//! cover was reached, and each assertion of a property can be. Without the checker the sampled form and the integer
//! obligations run, and the answer is "not run".

mod report;
mod run;
mod source;
mod table;
mod usage;

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use crate::mutants;
use crate::outcome::Outcome;
use crate::shell;
use report::{Answer, Verdict};
use run::{MEMORY_KIB, PROCESSOR_S, Which};
use usage::Usage;

const LOCK: &str = "proofs/harnesses.lock";
const INSTALL: &str = "Kani is not installed; install with `cargo install --locked kani-verifier && cargo kani setup`";
const USAGE: &str = "cargo xtask prove [--harness NAME] [--bless] | --mutants [--tests]";
/// Harnesses that run at the same time.
const JOBS: u32 = 2;

/// The command. Run from anywhere in the workspace.
pub fn run(args: &[String]) -> Outcome {
    let words: Vec<&str> = args.iter().map(String::as_str).collect();
    if let Err(why) = std::env::set_current_dir(shell::root()) {
        return Outcome::Failed(format!("the workspace: {why}"));
    }
    // Tests need no checker.
    if matches!(
        words.as_slice(),
        ["--mutants", "--tests"] | ["--tests", "--mutants"]
    ) {
        return mutants::by_tests();
    }
    match words.as_slice() {
        [] | ["--bless"] | ["--harness", _] | ["--mutants"] => {}
        _ => return Outcome::Usage(USAGE.into()),
    }
    if shell::capture(&mut kani_version()).is_none() {
        return without_checker();
    }
    match words.as_slice() {
        ["--mutants"] => mutants::by_proofs(),
        ["--harness", part] => some(part),
        _ => whole(words.contains(&"--bless")),
    }
}

fn kani_version() -> Command {
    let mut command = Command::new("cargo");
    command.args(["kani", "--version"]);
    command
}

fn target() -> std::path::PathBuf {
    shell::target("kani-gate")
}

/// Those whose name contains `part`; says nothing about the others, nor about the lock.
fn some(part: &str) -> Outcome {
    match run::run(
        Path::new("."),
        &target(),
        Which::Containing(part),
        JOBS,
        true,
    ) {
        Ok(found) if found.is_empty() => {
            Outcome::Failed(format!("no harness has `{part}` in its name"))
        }
        Ok(found) => {
            for (name, verdict) in &found {
                println!(
                    "{:>7.1} s {:>6}  {name}: {}",
                    verdict.seconds,
                    megabytes(verdict),
                    verdict.words()
                );
            }
            say(&found, wrong(&found))
        }
        Err(why) => Outcome::Failed(why),
    }
}

/// All of them, against the lock, with the table.
fn whole(bless: bool) -> Outcome {
    let (busy, begun) = (load(), Instant::now());
    let found = match run::run(Path::new("."), &target(), Which::All, JOBS, true) {
        Ok(found) => found,
        Err(why) => return Outcome::Failed(why),
    };
    let took = begun.elapsed().as_secs();
    if bless {
        let names: String = found
            .keys()
            .fold(String::new(), |text, name| text + name + "\n");
        if let Err(why) = std::fs::write(LOCK, names) {
            return Outcome::Failed(format!("{LOCK}: {why}"));
        }
    }
    let mut wrong = wrong(&found);
    match std::fs::read_to_string(LOCK) {
        Ok(locked) => wrong.extend(against_lock(&found, &locked)),
        Err(why) => wrong.push(format!("{LOCK}: {why}")),
    }
    let about = about(&found, took, busy);
    println!("{about}");
    if let Err(why) = table::write(&found, &about) {
        wrong.push(why);
    }
    say(&found, wrong)
}

/// What is not proved, or took more than a harness may.
fn wrong(found: &BTreeMap<String, Verdict>) -> Vec<String> {
    let mut wrong = Vec::new();
    for (name, verdict) in found {
        if !verdict.proved() {
            wrong.push(format!("{name}: {}", verdict.words()));
        }
        let usage = verdict.usage.unwrap_or_default();
        if usage.processor_s > PROCESSOR_S {
            wrong.push(format!(
                "{name}: {:.0} s of processor time, more than {PROCESSOR_S}",
                usage.processor_s
            ));
        }
        if usage.memory_kib > MEMORY_KIB {
            wrong.push(format!(
                "{name}: {}, more than {} MB",
                megabytes(verdict),
                MEMORY_KIB * 1024 / 1_000_000
            ));
        }
    }
    wrong
}

/// The harnesses that ran are those of the committed list.
fn against_lock(found: &BTreeMap<String, Verdict>, locked: &str) -> Vec<String> {
    let missing = locked.lines().filter(|name| !found.contains_key(*name));
    let missing = missing.map(|name| format!("{name}: in {LOCK}, but did not run"));
    let new = found
        .keys()
        .filter(|name| !locked.lines().any(|locked| locked == *name));
    let new = new.map(|name| format!("{name}: ran, but is not in {LOCK} (--bless adds it)"));
    missing.chain(new).collect()
}

fn say(found: &BTreeMap<String, Verdict>, wrong: Vec<String>) -> Outcome {
    for line in &wrong {
        println!("  {line}");
    }
    let proved = found.values().filter(|verdict| verdict.proved()).count();
    let text = format!(
        "{proved} of {} harnesses proved, every cover of theirs reached",
        found.len()
    );
    if wrong.is_empty() && proved > 0 {
        Outcome::Ok(text)
    } else {
        Outcome::Failed(format!("{text}; {} faults, listed above", wrong.len()))
    }
}

fn megabytes(verdict: &Verdict) -> String {
    let mb = |usage: Usage| format!("{:.0} MB", usage.memory_kib as f64 * 1024.0 / 1e6);
    verdict.usage.map_or("-".into(), mb)
}

/// The processes that others keep running, as the kernel's load of the last minute; before the run.
fn load() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/loadavg").ok()?;
    text.split_whitespace().next()?.parse().ok()
}

/// What there is to say of a whole run, above its table.
fn about(found: &BTreeMap<String, Verdict>, took_s: u64, load: Option<f64>) -> String {
    let proved = found.values().filter(|verdict| verdict.proved()).count();
    let processor = found
        .values()
        .map(|verdict| verdict.usage.unwrap_or_default().processor_s);
    let longest = processor.clone().fold(0.0, f64::max);
    let largest = found
        .values()
        .max_by_key(|verdict| verdict.usage.unwrap_or_default().memory_kib);
    let version = shell::capture(&mut kani_version()).unwrap_or_default();
    let shared = match load {
        Some(load) if load > 0.5 => {
            format!("The machine was shared with other work: {load:.1} processes ran before.")
        }
        Some(_) => "Nothing else ran on the machine before.".into(),
        None => "What else ran on the machine is not known.".into(),
    };
    format!(
        "{proved} of {} harnesses proved with every cover reached and every assertion reachable; {}, {JOBS} harnesses at a\n\
         time, {} min {:02} s by the clock with compiling. Processor time: {:.0} s in all harnesses together, {longest:.0} s in the\n\
         longest. Memory: at most {}. {shared}",
        found.len(),
        version.lines().next().unwrap_or("Kani"),
        took_s / 60,
        took_s % 60,
        processor.sum::<f64>(),
        largest.map_or("-".into(), megabytes),
    )
}

/// Whether one named harness refutes what stands in a workspace. `Err`: anything else than a proof or a refutation of that
/// very harness.
pub fn refutes(workspace: &Path, target: &Path, harness: &str) -> Result<bool, String> {
    let found = run::run(workspace, target, Which::Named(harness), 1, false)?;
    refuted(&found, harness)
}

fn refuted(found: &BTreeMap<String, Verdict>, harness: &str) -> Result<bool, String> {
    let verdict = found.get(harness).ok_or("the harness did not run")?;
    if found.len() != 1 {
        return Err("more than one harness ran".into());
    }
    match &verdict.answer {
        Answer::Proved => Ok(false),
        Answer::Refuted(_) => Ok(true),
        _ => Err(verdict.words()),
    }
}

/// What can be done without the checker, which does not replace it.
fn without_checker() -> Outcome {
    let mut tests = shell::cargo_locked("test");
    let sampled = shell::run(tests.args(["--quiet", "-p", "touchstone-proofs"]));
    if sampled.is_failure() {
        return Outcome::Failed(format!("the sampled and exhaustive form; {INSTALL}"));
    }
    let obligations = obligations();
    match &obligations {
        Outcome::Ok(_) => Outcome::NotRun(format!(
            "{INSTALL}; sampled form and integer obligations ran, no counterexample"
        )),
        Outcome::NotRun(why) => Outcome::NotRun(format!(
            "{INSTALL}; sampled form ran; integer obligations: {why}"
        )),
        other => Outcome::Failed(format!("the integer obligations: {other}; {INSTALL}")),
    }
}

/// The integer obligations in two solvers' Python wheels.
fn obligations() -> Outcome {
    let folder = shell::target("obligations-venv");
    let python = folder.join("bin/python");
    if !python.exists() {
        let mut venv = shell::program("python3");
        let mut install = shell::program(&python);
        install.args([
            "-m",
            "pip",
            "install",
            "-q",
            "-r",
            "proofs/obligations/requirements.txt",
        ]);
        if shell::run(venv.args(["-m", "venv"]).arg(&folder)).is_failure()
            || shell::run(&mut install).is_failure()
        {
            // Half a folder must not count as a whole one the next time.
            let _ = std::fs::remove_dir_all(&folder);
            return Outcome::NotRun(
                "no Python with the solvers' wheels; `apt-get install python3-venv`, network"
                    .into(),
            );
        }
    }
    shell::run(shell::program(&python).arg("proofs/obligations/check.py"))
}

#[cfg(test)]
mod tests;
