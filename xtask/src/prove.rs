//! `cargo xtask prove`: runs the proofs and believes only what it sees.
//!
//! The checker ends with 0 also when there was nothing to prove, when an assumption was impossible and when a cover was never
//! reached. So the gate reads its output: every harness of the committed list ran, no other did, each succeeded, and each
//! cover was reached. Without the checker the sampled form and the integer obligations run, and the answer is "not run".

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, ExitCode, Stdio};

const LOCK: &str = "proofs/harnesses.lock";
const README: &str = "proofs/README.md";
const INSTALL: &str = "not run: Kani is not installed; install with `cargo install --locked kani-verifier && cargo kani setup`";
/// Each harness; the checker counts a harness that runs into it as failed.
const TIMEOUT: &str = "120s";
/// Exit code of a command that could not do its work.
const NOT_RUN: u8 = 77;

/// What a run said about one harness.
#[derive(Debug, Default, Clone)]
struct Verdict {
    proved: bool,
    timed_out: bool,
    covers: Option<(u32, u32)>,
    seconds: f64,
}

impl Verdict {
    /// Proved, and every situation that it is about can occur.
    fn good(&self) -> bool {
        self.proved && matches!(self.covers, Some((reached, all)) if reached == all && all > 0)
    }
    fn words(&self) -> &'static str {
        if self.good() {
            "proved"
        } else if self.timed_out {
            "no answer in time"
        } else if self.proved {
            "proved, but a cover was not reached"
        } else {
            "refuted"
        }
    }
}

/// The command. Run from anywhere in the workspace.
pub fn run(args: &[String]) -> ExitCode {
    let mut harness = None;
    let mut mutants = false;
    let mut bless = false;
    let mut args = args.iter();
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--mutants" => mutants = true,
            "--bless" => bless = true,
            "--harness" => harness = args.next().cloned(),
            _ => {
                eprintln!("usage: cargo xtask prove [--harness NAME] [--mutants] [--bless]");
                return ExitCode::from(2);
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    if std::env::set_current_dir(&root).is_err() {
        eprintln!("prove: the workspace is gone");
        return ExitCode::FAILURE;
    }
    let installed = Command::new("cargo")
        .args(["kani", "--version"])
        .output()
        .is_ok_and(|out| out.status.success());
    if !installed {
        return without_checker();
    }
    if mutants {
        return crate::mutants::run();
    }
    let found = match check(
        Path::new("."),
        Path::new("target/kani-gate"),
        harness.as_deref(),
        true,
    ) {
        Ok(found) => found,
        Err(why) => {
            eprintln!("prove: {why}");
            return ExitCode::FAILURE;
        }
    };
    judge(&found, harness.is_some(), bless)
}

/// Runs the harnesses whose full name contains `filter`; progress on standard error.
fn check(
    workspace: &Path,
    target: &Path,
    filter: Option<&str>,
    progress: bool,
) -> Result<BTreeMap<String, Verdict>, String> {
    let mut command = Command::new("cargo");
    command
        .current_dir(workspace)
        .args([
            "kani",
            "-p",
            "touchstone-proofs",
            "-j",
            "2",
            "--output-format",
            "terse",
        ])
        .args(["-Z", "unstable-options", "--harness-timeout", TIMEOUT])
        .arg("--target-dir")
        .arg(target)
        .stdout(Stdio::piped())
        .stderr(Stdio::null());
    if let Some(filter) = filter {
        command.args(["--harness", filter]);
    }
    let mut child = command
        .spawn()
        .map_err(|why| format!("cargo kani: {why}"))?;
    let output = child.stdout.take().ok_or("cargo kani has no output")?;
    let mut found = BTreeMap::<String, Verdict>::new();
    // Two harnesses run at a time; a line belongs to the thread that was named last.
    let mut thread = String::new();
    let mut current = BTreeMap::<String, String>::new();
    for line in BufReader::new(output).lines() {
        let line = line.map_err(|why| why.to_string())?;
        let mut text = line.trim();
        if let Some((name, rest)) = text
            .strip_prefix("Thread ")
            .and_then(|rest| rest.split_once(':'))
        {
            name.clone_into(&mut thread);
            text = rest.trim();
        }
        if let Some(name) = text.strip_prefix("Checking harness ") {
            let name = name.trim_end_matches("...").to_string();
            found.insert(name.clone(), Verdict::default());
            current.insert(thread.clone(), name);
            continue;
        }
        let Some(name) = current.get(&thread) else {
            continue;
        };
        let Some(verdict) = found.get_mut(name) else {
            continue;
        };
        if text.contains("cover properties satisfied") {
            let mut numbers = text.split_whitespace().filter_map(|word| word.parse().ok());
            verdict.covers = numbers.next().zip(numbers.next());
        } else if text.starts_with("VERIFICATION:- SUCCESSFUL") {
            verdict.proved = true;
        } else if text.contains("timed out") {
            verdict.timed_out = true;
        }
        let time = text
            .strip_prefix("Verification Time: ")
            .map(|time| time.trim_end_matches('s'));
        if let Some(seconds) = time.and_then(|time| time.parse().ok()) {
            verdict.seconds = seconds;
        }
        if progress && (time.is_some() || text.contains("timed out")) {
            let verdict = verdict.clone();
            eprintln!("{:>7.1} s  {}  {name}", verdict.seconds, verdict.words());
        }
    }
    child.wait().map_err(|why| why.to_string())?;
    Ok(found)
}

/// Whether one harness refutes what stands in a workspace. `None`: no answer.
pub fn refutes(workspace: &Path, target: &Path, harness: &str) -> Option<bool> {
    let found = check(workspace, target, Some(harness), false).ok()?;
    let verdict = found.get(harness)?;
    if verdict.timed_out || found.len() != 1 {
        None
    } else {
        Some(!verdict.good())
    }
}

fn judge(found: &BTreeMap<String, Verdict>, partial: bool, bless: bool) -> ExitCode {
    let mut wrong = Vec::new();
    for (name, verdict) in found {
        if !verdict.good() {
            wrong.push(format!("{name}: {}", verdict.words()));
        }
    }
    if !partial {
        let names: String = found
            .keys()
            .fold(String::new(), |text, name| text + name + "\n");
        if bless {
            let _ = std::fs::write(LOCK, &names);
        }
        let locked = std::fs::read_to_string(LOCK).unwrap_or_default();
        for name in locked.lines().filter(|name| !found.contains_key(*name)) {
            wrong.push(format!("{name}: in {LOCK}, but did not run"));
        }
        for name in found
            .keys()
            .filter(|name| !locked.lines().any(|locked| locked == *name))
        {
            wrong.push(format!(
                "{name}: ran, but is not in {LOCK} (--bless adds it)"
            ));
        }
        write_table(found);
    }
    let good = found.values().filter(|verdict| verdict.good()).count();
    println!(
        "{good} of {} harnesses proved, every cover of theirs reached",
        found.len()
    );
    for line in &wrong {
        println!("  {line}");
    }
    if wrong.is_empty() && good > 0 {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

/// The first sentence above a property in its source, by its name.
fn meaning(harness: &str) -> String {
    let parts: Vec<&str> = harness.split("::").collect();
    let [file, .., name, _] = parts.as_slice() else {
        return String::new();
    };
    let source = std::fs::read_to_string(format!("proofs/src/{file}.rs")).unwrap_or_default();
    let mut words = String::new();
    for line in source.lines().map(str::trim) {
        if let Some(doc) = line.strip_prefix("/// ") {
            words = words + doc + " ";
        } else if line.contains(&format!("fn {name}(")) {
            return words.trim().replace('|', "\\|");
        } else {
            words.clear();
        }
    }
    String::new()
}

fn write_table(found: &BTreeMap<String, Verdict>) {
    let mut table =
        String::from("| harness | answer | s | covers | what it says |\n|---|---|---:|---|---|\n");
    for (name, verdict) in found {
        let covers = verdict
            .covers
            .map_or("-".into(), |(reached, all)| format!("{reached}/{all}"));
        let short = name.trim_end_matches("::proof");
        let _ = writeln!(
            table,
            "| `{short}` | {} | {:.1} | {covers} | {} |",
            verdict.words(),
            verdict.seconds,
            meaning(name)
        );
    }
    let (start, end) = (
        "<!-- table: written by `cargo xtask prove` -->\n",
        "<!-- end of table -->",
    );
    let page = std::fs::read_to_string(README).unwrap_or_default();
    if let (Some(from), Some(to)) = (page.find(start), page.find(end)) {
        let page = format!("{}{table}{}", &page[..from + start.len()], &page[to..]);
        let _ = std::fs::write(README, page);
    }
}

fn without_checker() -> ExitCode {
    println!("{INSTALL}");
    let ran = |what: &str, program: &str, args: &[&str]| {
        let ok = Command::new(program)
            .args(args)
            .status()
            .is_ok_and(|status| status.success());
        println!(
            "{what}: {}",
            if ok {
                "ran, no counterexample"
            } else {
                "FAILED or could not run"
            }
        );
        ok
    };
    let sampled = ran(
        "sampled and exhaustive 8-bit form",
        "cargo",
        &["test", "--quiet", "-p", "touchstone-proofs"],
    );
    let python = "target/obligations-venv/bin/python";
    let ready = Path::new(python).exists()
        || (ran(
            "python venv",
            "python3",
            &["-m", "venv", "target/obligations-venv"],
        ) && ran(
            "solvers",
            python,
            &[
                "-m",
                "pip",
                "install",
                "-q",
                "-r",
                "proofs/obligations/requirements.txt",
            ],
        ));
    if !ready {
        println!(
            "integer obligations: not run: no Python venv with the solvers; apt-get install python3-venv"
        );
    }
    let obliged = !ready
        || ran(
            "integer obligations",
            python,
            &["proofs/obligations/check.py"],
        );
    if sampled && obliged {
        ExitCode::from(NOT_RUN)
    } else {
        ExitCode::FAILURE
    }
}
