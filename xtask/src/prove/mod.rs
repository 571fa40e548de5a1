//! `cargo xtask prove`: runs the proofs and believes only what it sees.
//!
//! The checker ends with 0 also when there was nothing to prove, when an assumption was impossible and when a cover was never
//! reached. So the gate in `inspect/` reads its report: every harness of the committed list ran, no other did, each succeeded,
//! each cover was reached, and each assertion of a property can be. Without the checker the sampled form runs, and the answer is
//! "not run". The theorems over traces ([`coq`]) need no checker, but Coq; the integer obligations, on which some harnesses rest, two
//! solvers; properties with few inputs ([`every`]) neither. What a board's machine code does ([`elf`]) is proved by itself, and read on samples
//! where the checker is not.

pub mod allocator;
pub mod checker;
pub mod coq;
mod elf;
mod every;
mod solvers;
mod usage;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::mpsc;
use std::time::Instant;

use crate::mutants::{self, Shard};
use crate::outcome::Outcome;
use crate::{inspect, shell, unit};
use checker::{How, Left, MEMORY_KIB, Which};

const INSTALL: &str = "Kani is not installed; install with `cargo install --locked kani-verifier && cargo kani setup`";
const USAGE: &str = "cargo xtask prove [--harness NAME] [--bless] [--resume] [--jobs N] | --theorems | --every [NAME] | --elf [--mutants] [--board BOARD] [NAME] | --mutants [--tests] [--shard I/N] | --mutants --theorems";
/// The crates that the proofs use; no other has to build.
pub const PARTS: [&str; 4] = ["control", "protocol", "drive", "proofs"];
const LOCK: &str = "proofs/harnesses.lock";
/// File of the earlier results, beside the report.
const MEMO: &str = "proved.tsv";
/// Harnesses of a part of a run that is taken up again.
const AT_A_TIME: usize = 52;
/// Harnesses that run at the same time, where `--jobs` does not say.
const JOBS: u32 = 2;

/// The command. Run from anywhere in the workspace.
pub fn run(args: &[String]) -> Outcome {
    let mut words: Vec<&str> = args.iter().map(String::as_str).collect();
    if let Err(why) = std::env::set_current_dir(shell::root()) {
        return Outcome::Failed(format!("the workspace: {why}"));
    }
    match words.as_slice() {
        ["--theorems"] => return coq::run(),
        ["--elf", "--mutants", rest @ ..] | ["--mutants", "--elf", rest @ ..] => {
            return of_program(rest, elf::mutants);
        }
        ["--elf", rest @ ..] => return of_program(rest, elf::run),
        ["--every"] => return every::run(""),
        ["--every", part] => return every::run(part),
        ["--mutants", "--theorems"] | ["--theorems", "--mutants"] => return coq::mutants(),
        // Tests need no checker.
        ["--mutants", "--tests", rest @ ..] => {
            return part(rest).map_or_else(usage, mutants::by_tests);
        }
        ["--mutants", rest @ ..] => {
            return part(rest).map_or_else(usage, |shard| match has_checker() {
                true => mutants::by_proofs(shard),
                false => Outcome::NotRun(INSTALL.into()),
            });
        }
        _ => {}
    }
    let jobs = match words.as_slice() {
        [before @ .., "--jobs", jobs] => {
            let jobs = jobs.parse().ok().filter(|jobs| (1..=64).contains(jobs));
            words = before.to_vec();
            jobs
        }
        _ => Some(JOBS),
    };
    let known = matches!(
        words.as_slice(),
        [] | ["--bless"]
            | ["--resume"]
            | ["--bless", "--resume"]
            | ["--resume", "--bless"]
            | ["--harness", _]
    );
    let Some(jobs) = jobs.filter(|_| known) else {
        return usage();
    };
    if !has_checker() {
        return without_checker();
    }
    match words.as_slice() {
        ["--harness", part] => some(part, jobs),
        _ => {
            let (bless, resume) = (words.contains(&"--bless"), words.contains(&"--resume"));
            // The checker's compiler has one core to do with for minutes: integer obligations and Coq have the other. The trials of all
            // inputs have what is left over, at the end too, when the last harness has one core.
            let (tell, told) = mpsc::channel();
            let beside = std::thread::spawn(move || {
                let obligations = obligations();
                println!("integer obligations: {obligations}");
                // Nobody waits for it where the checker did not start.
                let _ = tell.send(obligations.is_failure());
                inspect::build();
                let theorems = coq::run();
                let every = every::run_beside();
                println!("all inputs: {every}");
                (obligations, theorems, every)
            });
            // Nothing is blessed that rests on what does not hold.
            let bless = || bless && !told.recv().unwrap_or(true);
            let harnesses = whole(bless, resume, jobs);
            println!("harnesses: {harnesses}");
            let panicked = |_| {
                let failed = || Outcome::Failed("the run beside the harnesses' panicked".into());
                (failed(), failed(), failed())
            };
            let (obligations, theorems, every) = beside.join().unwrap_or_else(panicked);
            let harnesses = with_obligations(obligations, with_every(every, harnesses));
            with_theorems(theorems, harnesses)
        }
    }
}

/// `[--board BOARD] [NAME]`: of which board's program, and which of its ticks.
fn of_program(words: &[&str], asked: fn(&str, &str) -> Outcome) -> Outcome {
    match words {
        [] => asked(elf::BOARD, ""),
        ["--board", board] => asked(board, ""),
        ["--board", board, part] if !part.starts_with("--") => asked(board, part),
        [part] if !part.starts_with("--") => asked(elf::BOARD, part),
        _ => usage(),
    }
}

/// `--shard I/N`, or nothing: all.
fn part(words: &[&str]) -> Option<Shard> {
    match words {
        [] => Some(Shard::ALL),
        ["--shard", text] => Shard::read(text),
        _ => None,
    }
}

fn usage() -> Outcome {
    Outcome::Usage(USAGE.into())
}

fn has_checker() -> bool {
    shell::capture(&mut kani_version()).is_some()
}

/// Joins the outcomes of harnesses and of exhaustive properties: a failure first, else the harnesses' outcome.
fn with_every(every: Outcome, harnesses: Outcome) -> Outcome {
    if every.is_failure() { every } else { harnesses }
}

/// Joins the outcomes of harnesses and of the arithmetic that some of them need: a failure first, then what did not
/// run, else the harnesses' outcome.
fn with_obligations(obligations: Outcome, harnesses: Outcome) -> Outcome {
    let said = format!("{}; integer obligations", harnesses.reason());
    match obligations {
        Outcome::Ok(_) if matches!(harnesses, Outcome::Ok(_)) => {
            Outcome::Ok(format!("{said} hold in both solvers"))
        }
        Outcome::Ok(_) => harnesses,
        Outcome::NotRun(why) if !harnesses.is_failure() => {
            Outcome::NotRun(format!("{said}: {why}"))
        }
        other => Outcome::Failed(format!("{said}: {other}")),
    }
}

/// Harnesses with theorems: what failed, else what did not run, else both.
fn with_theorems(theorems: Outcome, harnesses: Outcome) -> Outcome {
    let both = format!("{}; {}", theorems.reason(), harnesses.reason());
    if theorems.is_failure() || harnesses.is_failure() {
        Outcome::Failed(both)
    } else if matches!((&theorems, &harnesses), (Outcome::Ok(_), Outcome::Ok(_))) {
        Outcome::Ok(both)
    } else {
        Outcome::NotRun(both)
    }
}

fn kani_version() -> Command {
    let mut command = Command::new("cargo");
    command.args(["kani", "--version"]);
    command
}

/// Versions of the checker, of its compiler and of its solvers.
fn versions() -> String {
    let mut kani = kani_version();
    kani.arg("--verbose");
    let mut said = vec![shell::capture(&mut kani).or_else(|| shell::capture(&mut kani_version()))];
    for program in ["cbmc", "kissat", "cadical", "cvc5", "z3"] {
        let version = shell::capture(shell::program(program).arg("--version"));
        let first = version.and_then(|text| text.lines().next().map(str::to_owned));
        said.push(Some(format!(
            "{program} {}",
            first.unwrap_or("not there".into())
        )));
    }
    let said: Vec<String> = said.into_iter().flatten().collect();
    said.join("; ").replace('\n', ", ")
}

fn target() -> std::path::PathBuf {
    shell::target("kani-gate")
}

/// Runs the harnesses whose name contains `part`; the others and the lock are not checked.
fn some(part: &str, jobs: u32) -> Outcome {
    let which = Which::Containing(part);
    match checker::run(Path::new("."), &target(), which, How::jobs(jobs)) {
        Ok(left) => gate(&left, &[part]),
        Err(why) => Outcome::Failed(why),
    }
}

/// Runs all harnesses, checks them against the lock, and writes the table. Resumed: only those that were not yet
/// proved for the present code and statements.
fn whole(bless: impl FnOnce() -> bool, resume: bool, jobs: u32) -> Outcome {
    let (machine, begun) = (machine(load()), Instant::now());
    let left = if resume {
        remaining(jobs)
    } else {
        // What an older run proved does not count in a whole one.
        let _ = std::fs::remove_file(target().join(MEMO));
        checker::run(Path::new("."), &target(), Which::All, How::jobs(jobs))
            .map(|left| (left, None))
    };
    let (left, list) = match left {
        Ok(left) => left,
        Err(why) => return Outcome::Failed(why),
    };
    let took_s = begun.elapsed().as_secs();
    let parts = if resume { " in parts, the last of" } else { "" };
    let run = format!(
        "{}, {}, {jobs} harnesses at a\ntime,{parts} {} min {:02} s by the clock with compiling.",
        versions(),
        allocator::said(),
        took_s / 60,
        took_s % 60,
    );
    let mut words = vec![run, machine];
    if bless() {
        words.push("--bless".into());
    }
    if let Some(list) = list {
        words.extend(["--resume".into(), list.display().to_string()]);
    }
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    gate(&left, &words)
}

/// Runs the harnesses that are not yet proved, some at a time, so that an interruption loses little; returns the last
/// run, and the list.
fn remaining(jobs: u32) -> Result<(Left, Option<PathBuf>), String> {
    let list = checker::list(&target())?;
    let memo = target().join(MEMO);
    let words = ["remaining".as_ref(), list.as_os_str(), memo.as_os_str()];
    let (names, outcome) = inspect::ask(words);
    println!("{outcome}");
    let mut last = None;
    for names in names.chunks(AT_A_TIME) {
        let left = checker::run(
            Path::new("."),
            &target(),
            Which::These(names),
            How::jobs(jobs),
        )?;
        let outcome = gate(&left, &["::"]);
        println!("{outcome}");
        last = Some(left);
    }
    // Nothing was left to run: a run of one, for the gate to read.
    let left = match last {
        Some(left) => left,
        None => checker::run(
            Path::new("."),
            &target(),
            Which::Containing("p9_angle16"),
            How::jobs(jobs),
        )?,
    };
    Ok((left, Some(list)))
}

fn gate(left: &Left, more: &[&str]) -> Outcome {
    let memory = MEMORY_KIB.to_string();
    let words: [&OsStr; 4] = [
        "proofs".as_ref(),
        left.report.as_os_str(),
        left.usage.as_os_str(),
        memory.as_ref(),
    ];
    inspect::call(words.into_iter().chain(more.iter().map(OsStr::new)))
}

/// The processes that others keep running, as the kernel's load of the last minute; before the run.
fn load() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/loadavg").ok()?;
    text.split_whitespace().next()?.parse().ok()
}

/// What there is to say of the machine that a whole run had.
fn machine(load: Option<f64>) -> String {
    match load {
        Some(load) if load > 0.5 => {
            format!("The machine was shared with other work: {load:.1} processes ran before.")
        }
        Some(_) => "Nothing else ran on the machine before.".into(),
        None => "What else ran on the machine is not known.".into(),
    }
}

/// Runs the tests that need no checker; they do not replace it.
fn without_checker() -> Outcome {
    let theorems = coq::run();
    println!("theorems over traces: {theorems}");
    with_theorems(theorems, without_harnesses())
}

fn without_harnesses() -> Outcome {
    // `cargo xtask test` has run them before, among all others.
    if !unit::all_passed() {
        let mut tests = shell::cargo_locked("test");
        let sampled = shell::run(tests.args(["--quiet", "-p", "touchstone-proofs"]));
        if sampled.is_failure() {
            return Outcome::Failed(format!("the sampled and exhaustive form; {INSTALL}"));
        }
    }
    let every = every::run(every::SAMPLE);
    if every.is_failure() {
        return every;
    }
    let statements = inspect::call(["statements", LOCK]);
    let statements = statements.reason();
    let readings = elf::readings();
    if readings.is_failure() {
        return Outcome::Failed(format!("the machine code's readings: {readings}"));
    }
    let obligations = obligations();
    match &obligations {
        Outcome::Ok(_) => Outcome::NotRun(format!(
            "{INSTALL}; sampled form and integer obligations ran, no counterexample; machine code: {readings}; {statements}"
        )),
        Outcome::NotRun(why) => Outcome::NotRun(format!(
            "{INSTALL}; sampled form ran; integer obligations: {why}; machine code: {readings}; {statements}"
        )),
        other => Outcome::Failed(format!("the integer obligations: {other}; {INSTALL}")),
    }
}

/// Runs the integer obligations in two solvers' Python wheels, and the part of the machine code's checker that needs
/// no machine code.
fn obligations() -> Outcome {
    let python = match with_wheels("obligations-venv", "proofs/obligations/requirements.txt") {
        Ok(python) => python,
        Err(outcome) => return outcome,
    };
    let checked = shell::run(shell::program(&python).arg("proofs/obligations/check.py"));
    if checked.is_failure() {
        return checked;
    }
    elf::read(&python)
}

/// A Python that has the wheels of a list, in a folder below `target/`.
fn with_wheels(folder: &str, list: &str) -> Result<PathBuf, Outcome> {
    let folder = shell::target(folder);
    let (python, made_of) = (folder.join("bin/python"), folder.join("made-of.txt"));
    let wanted = std::fs::read_to_string(list).ok();
    // One that was broken off, or made of another list, is made anew.
    if wanted.is_none() || std::fs::read_to_string(&made_of).ok() != wanted {
        let _ = std::fs::remove_dir_all(&folder);
        let mut venv = shell::program("python3");
        let mut install = shell::program(&python);
        install.args(["-m", "pip", "install", "-q", "-r", list]);
        if shell::run(venv.args(["-m", "venv"]).arg(&folder)).is_failure()
            || shell::run(&mut install).is_failure()
        {
            // Half a folder must not count as a whole one the next time.
            let _ = std::fs::remove_dir_all(&folder);
            return Err(Outcome::NotRun(
                "no Python with the solvers' wheels; `apt-get install python3-venv`, network"
                    .into(),
            ));
        }
        let _ = std::fs::write(&made_of, wanted.unwrap_or_default());
    }
    Ok(python)
}
