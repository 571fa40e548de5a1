//! `cargo xtask prove`: runs the proofs and checks that each one really proved its statement.
//!
//! A harness is one proof of the model checker; a cover is a statement that must be reachable. The model checker also exits with 0
//! if there was nothing to prove, an assumption was impossible, or a cover was never reached. So the crate `inspect/` reads the
//! checker's report. Every harness of the committed list must have run and succeeded, and no other may have run. Every cover and
//! every assertion of a property must be reachable. If the checker is not installed, tests on samples run instead and the outcome
//! is "not run".
//!
//! Other proofs do not need the model checker:
//! - The theorems about sequences of control periods ([`coq`]) need Coq.
//! - The integer obligations, lemmas on which some harnesses rest, need two solvers.
//! - Properties with few inputs ([`every`]) need no further program.
//! - The machine code of a board ([`elf`]) has its own command. If the model checker is not installed, the machine code runs on
//!   sample inputs, without a proof.

pub mod allocator;
pub mod checker;
pub mod coq;
mod elf;
mod every;
mod mutants;
mod solvers;
mod usage;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::mpsc;
use std::time::Instant;

use crate::outcome::Outcome;
use crate::step::{Gates, Share};
use crate::{inspect, shell, unit};
use checker::{How, Left, MEMORY_KIB, Which};
use mutants::Shard;

const INSTALL: &str = "Kani is not installed; install with `cargo install --locked kani-verifier && cargo kani setup`";
const USAGE: &str = "cargo xtask prove [--harness NAME] [--bless] [--resume] [--jobs N] | --theorems | --every [NAME] | --elf [--mutants] [--board BOARD] [NAME] | --mutants [--tests] [--shard I/N] | --mutants --theorems";
/// The crates that the proofs use; only these are copied and built for mutation tests.
pub const PARTS: [&str; 4] = ["control", "protocol", "drive", "proofs"];
const LOCK: &str = "proofs/harnesses.lock";
/// File with the results of earlier runs of the proofs, in the folder of the report.
const MEMO: &str = "proved.tsv";
/// Number of harnesses (proofs) after which a resumed run stores its results.
const AT_A_TIME: usize = 52;
/// Number of harnesses (proofs) that run at the same time if `--jobs` is not given.
const JOBS: u32 = 2;

/// The full test run proves what is not yet proved for the present code. If the functions of a harness did not change, its line in
/// the lock stays valid.
pub const GATES: Gates = Gates {
    full: Share::Part(
        &["--resume"],
        "harnesses whose line in `proofs/harnesses.lock` is of today's code: `cargo xtask prove` proves them again; wrong changes (`--mutants`)",
    ),
    ..Gates::NONE
};

/// Runs `cargo xtask prove` with these arguments, from any folder of the workspace.
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
        // The tests need no model checker.
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
            // The checker's compiler uses one core for minutes, so the integer obligations and Coq run on another. The trials of
            // all inputs have low priority and use the remaining time.
            let (tell, told) = mpsc::channel();
            let beside = std::thread::spawn(move || {
                let obligations = obligations();
                println!("integer obligations: {obligations}");
                // Nobody receives the message if the checker did not start.
                let _ = tell.send(obligations.is_failure());
                inspect::build();
                let theorems = coq::run();
                let every = every::run_beside();
                println!("all inputs: {every}");
                (obligations, theorems, every)
            });
            // The lock is not updated if the integer obligations, on which harnesses rest, have failed.
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

/// Parses `[--board BOARD] [NAME]` and calls `asked` with the board and with NAME, a part of the names of the functions to prove.
fn of_program(words: &[&str], asked: fn(&str, &str) -> Outcome) -> Outcome {
    match words {
        [] => asked(elf::BOARD, ""),
        ["--board", board] => asked(board, ""),
        ["--board", board, part] if !part.starts_with("--") => asked(board, part),
        [part] if !part.starts_with("--") => asked(elf::BOARD, part),
        _ => usage(),
    }
}

/// Parses `--shard I/N`, the part I of N parts of a list; without arguments the result is the whole list.
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

/// Combines the outcomes of the harnesses (proofs) and of the trials of all inputs. A failure of the trials counts first; otherwise
/// the harnesses' outcome counts.
fn with_every(every: Outcome, harnesses: Outcome) -> Outcome {
    if every.is_failure() { every } else { harnesses }
}

/// Combines the outcomes of the harnesses (proofs) and of the integer obligations (lemmas on which some harnesses rest). The result
/// is a failure if one of them failed, else "not run" if one was not run, else a success.
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

/// Combines the outcomes of the harnesses (proofs) and of the Coq theorems. A failure counts first, then "not run"; otherwise the
/// result names both successes.
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

/// Text with the versions of the checker, its compiler and its solvers.
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

/// Runs the harnesses (proofs) whose names contain `part`, without a comparison with the committed list.
fn some(part: &str, jobs: u32) -> Outcome {
    let which = Which::Containing(part);
    match checker::run(Path::new("."), &target(), which, How::jobs(jobs)) {
        Ok(left) => gate(&left, &[part]),
        Err(why) => Outcome::Failed(why),
    }
}

/// Runs all harnesses (proofs), checks them against the committed list (lock), and writes the table of results. With `resume`, it
/// runs only the harnesses that are not yet proved for the present code and statements. `bless` returns whether to write new lines
/// into the list.
fn whole(bless: impl FnOnce() -> bool, resume: bool, jobs: u32) -> Outcome {
    let (machine, begun) = (machine(load()), Instant::now());
    let left = if resume {
        remaining(jobs)
    } else {
        // A whole run does not count the results of earlier runs.
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

/// Runs the harnesses (proofs) that are not yet proved, [`AT_A_TIME`] at a time, so that an interruption loses little. Returns the
/// last run and the file with the list of all harnesses.
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
    // If no harness was left to run, one short harness runs, so that the gate has a report to read.
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

/// The kernel's average number of running processes in the last minute; `None` if it is unknown.
fn load() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/loadavg").ok()?;
    text.split_whitespace().next()?.parse().ok()
}

/// Sentence for the table of results that says how busy the machine was before the run.
fn machine(load: Option<f64>) -> String {
    match load {
        Some(load) if load > 0.5 => {
            format!("The machine was shared with other work: {load:.1} processes ran before.")
        }
        Some(_) => "Nothing else ran on the machine before.".into(),
        None => "What else ran on the machine is not known.".into(),
    }
}

/// Runs those theorems and tests that need no model checker. They do not replace its proofs.
fn without_checker() -> Outcome {
    let theorems = coq::run();
    println!("theorems over traces: {theorems}");
    with_theorems(theorems, without_harnesses())
}

fn without_harnesses() -> Outcome {
    // In `cargo xtask test` these tests have already run among all others.
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

/// Proves the integer obligations (lemmas on which some harnesses rest) with the Python packages of two solvers. Then compares the
/// specification of the machine code with the Rust code.
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

/// Creates a Python environment below `target/` with the packages that the file `list` names, unless it exists; returns the path of
/// its Python.
fn with_wheels(folder: &str, list: &str) -> Result<PathBuf, Outcome> {
    let folder = shell::target(folder);
    let (python, made_of) = (folder.join("bin/python"), folder.join("made-of.txt"));
    let wanted = std::fs::read_to_string(list).ok();
    // An environment that is incomplete, or has the packages of another list, is made again.
    if wanted.is_none() || std::fs::read_to_string(&made_of).ok() != wanted {
        let _ = std::fs::remove_dir_all(&folder);
        let mut venv = shell::program("python3");
        let mut install = shell::program(&python);
        install.args(["-m", "pip", "install", "-q", "-r", list]);
        if shell::run(venv.args(["-m", "venv"]).arg(&folder)).is_failure()
            || shell::run(&mut install).is_failure()
        {
            // Removes an incomplete environment, so that the next run does not use it.
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
