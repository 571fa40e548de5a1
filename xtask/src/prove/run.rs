//! One run of the checker, with its report.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

use super::report::{self, Verdict};
use super::usage::Watch;

/// Processor time of each harness, all its tools and solvers together.
pub const PROCESSOR_S: f64 = 120.0;
/// The checker ends a harness that takes longer by the clock, which is no answer: four times as long, for a machine that others
/// use as well.
const TIMEOUT_S: u32 = 480;
/// Each process that the checker starts, by `ulimit -v`; one that needs more fails.
pub const MEMORY_KIB: u64 = 8 << 20;

/// Which harnesses.
#[derive(Debug, Clone, Copy)]
pub enum Which<'a> {
    All,
    /// Those whose name contains this.
    Containing(&'a str),
    /// The one of this name.
    Named(&'a str),
}

/// Runs harnesses of the workspace in `workspace`, `jobs` at a time; progress on standard error.
pub fn run(
    workspace: &Path,
    target: &Path,
    which: Which,
    jobs: u32,
    progress: bool,
) -> Result<BTreeMap<String, Verdict>, String> {
    std::fs::create_dir_all(target).map_err(|why| format!("{}: {why}", target.display()))?;
    let target = target
        .canonicalize()
        .map_err(|why| format!("{}: {why}", target.display()))?;
    let report = target.join("report.json");
    // An old one must not be taken for this run's.
    let _ = std::fs::remove_file(&report);
    let (jobs, seconds) = (jobs.to_string(), format!("{TIMEOUT_S}s"));
    // The shell's limit is inherited by all that is started. A shell that cannot set it does not run the checker.
    let mut command = Command::new("sh");
    command
        .current_dir(workspace)
        .args([
            "-c",
            &format!("ulimit -v {MEMORY_KIB} && exec cargo kani \"$@\""),
            "sh",
        ])
        .args([
            "-p",
            "touchstone-proofs",
            "-j",
            &jobs,
            "--output-format",
            "terse",
        ])
        .args(["-Z", "unstable-options", "--harness-timeout", &seconds])
        .arg("--export-json")
        .arg(&report)
        .arg("--target-dir")
        .arg(&target)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    match which {
        Which::All => {}
        Which::Containing(part) => drop(command.args(["--harness", part])),
        Which::Named(name) => drop(command.args(["--exact", "--harness", name])),
    }
    let watch = Watch::start(&target);
    let mut child = command
        .spawn()
        .map_err(|why| format!("cargo kani: {why}"))?;
    let errors = child.stderr.take().map(|errors| {
        std::thread::spawn(move || {
            let lines = BufReader::new(errors).lines().map_while(Result::ok);
            lines
                .filter(|line| line.starts_with("error"))
                .collect::<Vec<_>>()
        })
    });
    if let Some(output) = child.stdout.take() {
        show_progress(BufReader::new(output), progress);
    }
    child.wait().map_err(|why| why.to_string())?;
    let usage = watch.finish();
    let errors = errors
        .and_then(|thread| thread.join().ok())
        .unwrap_or_default();
    // The exit code says nothing that the report does not: it is 0 for an empty proof and 1 for a refutation.
    let text = std::fs::read_to_string(&report).map_err(|_| {
        let first = errors.first().map_or("it gave no reason", String::as_str);
        format!("no report from the checker (Kani 0.67 or newer with --export-json): {first}")
    })?;
    let mut found = report::read(&text)?;
    for verdict in found.values_mut() {
        verdict.usage = usage.get(&verdict.program).copied();
    }
    Ok(found)
}

/// A line for each harness as it ends. For the eyes only; the verdicts are the report's.
fn show_progress(output: impl BufRead, show: bool) {
    // Several harnesses run at a time; a line belongs to the thread that was named last.
    let mut thread = String::new();
    let mut current = BTreeMap::<String, String>::new();
    let mut count = 0;
    for line in output.lines().map_while(Result::ok) {
        let mut text = line.trim();
        if let Some((name, rest)) = text
            .strip_prefix("Thread ")
            .and_then(|rest| rest.split_once(':'))
        {
            name.clone_into(&mut thread);
            text = rest.trim();
        }
        if let Some(name) = text.strip_prefix("Checking harness ") {
            current.insert(thread.clone(), name.trim_end_matches('.').to_string());
            continue;
        }
        let time = text.strip_prefix("Verification Time: ");
        if time.is_none() && !text.starts_with("CBMC timed out") {
            continue;
        }
        count += 1;
        let name = current
            .get(&thread)
            .map_or("?", |name| name.trim_end_matches("::proof"));
        if show {
            let time = time.and_then(|time| time.trim_end_matches('s').parse::<f64>().ok());
            let time = time.map_or("no answer".into(), |time| format!("{time:.1} s"));
            eprintln!("{count:>4} {time:>10}  {name}");
        }
    }
}
