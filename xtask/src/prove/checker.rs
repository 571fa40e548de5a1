//! Runs the model checker (Kani) once and collects its report. A harness is one proof, as Kani calls it.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::usage::Watch;
use super::{allocator, solvers};
use crate::inspect;
use crate::outcome::Outcome;

/// Most processor time of each process that the model checker starts, in seconds (`ulimit -t`). A process that exceeds it gives no
/// result. The gate in `inspect/` allows slightly less, for all processes of a harness (proof) together.
const PROCESS_S: u32 = 150;
/// Wall-clock time in seconds after which the model checker aborts a harness (proof). It is long, because other work may slow the
/// machine down.
const TIMEOUT_S: u32 = 2400;
/// Most memory of each process that the model checker starts, in KiB (`ulimit -v`). A process that needs more fails.
pub const MEMORY_KIB: u64 = 8 << 20;

/// Result files of a finished run of the model checker.
pub struct Left {
    pub report: PathBuf,
    /// File with one line per harness (proof): name of the file that the checker's tools worked on, memory in KiB, processor time
    /// in seconds.
    pub usage: PathBuf,
}

/// Settings of a run of the model checker.
#[derive(Debug, Clone, Copy)]
pub struct How {
    /// Number of harnesses (proofs) that run at the same time.
    pub jobs: u32,
    /// Whether progress is printed to standard error.
    pub progress: bool,
}

impl How {
    /// Runs one harness (proof) after the other without printing progress.
    pub const QUIET: Self = Self {
        jobs: 1,
        progress: false,
    };

    /// Runs `jobs` harnesses (proofs) at the same time and prints progress.
    pub const fn jobs(jobs: u32) -> Self {
        Self {
            jobs,
            progress: true,
        }
    }
}

/// Selects the harnesses (proofs) to run.
#[derive(Debug, Clone, Copy)]
pub enum Which<'a> {
    All,
    /// The harnesses (proofs) whose names contain this text.
    Containing(&'a str),
    /// The single harness (proof) with this name.
    Named(&'a str),
    /// The harnesses (proofs) with these names.
    These(&'a [String]),
}

/// Runs the model checker on the selected harnesses (proofs) of the sources in `workspace`. Build results and reports go to the
/// folder `target`.
pub fn run(workspace: &Path, target: &Path, which: Which, how: How) -> Result<Left, String> {
    std::fs::create_dir_all(target).map_err(|why| format!("{}: {why}", target.display()))?;
    let target = target
        .canonicalize()
        .map_err(|why| format!("{}: {why}", target.display()))?;
    let report = target.join("report.json");
    // Removes an old report, which must not be read as this run's.
    let _ = std::fs::remove_file(&report);
    let (jobs, seconds) = (how.jobs.to_string(), format!("{TIMEOUT_S}s"));
    let path = std::env::var_os("PATH").unwrap_or_default();
    let path = solvers::first(&target, path)?;
    // All processes started by the shell inherit its limits. If the shell cannot set them, it does not start the checker.
    let mut command = Command::new("sh");
    command
        .current_dir(workspace)
        .args([
            "-c",
            &format!("ulimit -v {MEMORY_KIB} && ulimit -t {PROCESS_S} && exec cargo kani \"$@\""),
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
        // The gate requires covers for the properties' own assertions; assertions in the code need no test of reachability.
        .arg("--no-assertion-reach-checks")
        .arg("--export-json")
        .arg(&report)
        .arg("--target-dir")
        .arg(&target)
        .env("PATH", path)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    match which {
        Which::All => {}
        Which::Containing(part) => drop(command.args(["--harness", part])),
        Which::Named(name) => drop(command.args(["--exact", "--harness", name])),
        Which::These(names) => {
            command.arg("--exact");
            for name in names {
                command.args(["--harness", name]);
            }
        }
    }
    allocator::give(&mut command);
    let watch = Watch::start(&target);
    let why = to_end(&mut command, how.progress)?;
    let taken = watch.finish();
    // The exit code adds nothing to the report: it is 0 also for an empty proof, and 1 for a refutation.
    if !report.is_file() {
        return Err(format!(
            "no report from the checker (Kani 0.67 or newer with --export-json): {why}"
        ));
    }
    let mut lines = String::new();
    for (program, taken) in taken {
        let _ = writeln!(
            lines,
            "{program} {} {}",
            taken.memory_kib, taken.processor_s
        );
    }
    let usage = target.join("usage.txt");
    std::fs::write(&usage, lines).map_err(|why| format!("{}: {why}", usage.display()))?;
    Ok(Left { report, usage })
}

/// Runs the model checker to its end. Returns a text that explains why, in case the checker leaves no report.
fn to_end(command: &mut Command, progress: bool) -> Result<String, String> {
    let mut child = command
        .spawn()
        .map_err(|why| format!("cargo kani: {why}"))?;
    let errors = child.stderr.take().map(|errors| {
        std::thread::spawn(move || {
            let lines = BufReader::new(errors).lines().map_while(Result::ok);
            lines.collect::<Vec<_>>()
        })
    });
    if let Some(output) = child.stdout.take() {
        show_progress(BufReader::new(output), progress);
    }
    let status = child.wait().map_err(|why| why.to_string())?;
    let errors = errors
        .and_then(|thread| thread.join().ok())
        .unwrap_or_default();
    Ok(reason(&errors).unwrap_or_else(|| format!("it gave no reason; {status}")))
}

/// The lines of standard error that say why the checker ended: the first error line, else the last two lines that are neither
/// progress nor advice.
fn reason(errors: &[String]) -> Option<String> {
    let mut lines = errors.iter().map(|line| line.trim_end());
    let is_error = |line: &&str| line.to_lowercase().starts_with("error");
    if let Some(error) = lines.clone().find(is_error) {
        return Some(error.to_owned());
    }
    if let Some(error) = lines.find(|line| line.to_lowercase().contains("error:")) {
        return Some(error.trim_start().to_owned());
    }
    // Cargo indents its lines of progress with spaces.
    let is_other = |line: &&String| {
        let advice = ["note:", "help:", "warning:"];
        !line.trim().is_empty()
            && !line.starts_with("   ")
            && !advice.iter().any(|word| line.starts_with(word))
    };
    let others: Vec<&str> = errors
        .iter()
        .filter(is_other)
        .map(|line| line.trim_end())
        .collect();
    let last = &others[others.len().saturating_sub(2)..];
    (!last.is_empty()).then(|| last.join(" "))
}

/// Path of the file with the model checker's list of all harnesses (proofs), below the folder `target`. The file is written anew if
/// a source of the proofs is newer.
pub fn list(target: &Path) -> Result<PathBuf, String> {
    std::fs::create_dir_all(target).map_err(|why| format!("{}: {why}", target.display()))?;
    let list = target.join("list.json");
    let changed = |path: &Path| path.metadata().and_then(|it| it.modified()).ok();
    let newest = std::fs::read_dir("proofs/src").map_err(|why| format!("proofs/src: {why}"))?;
    let newest = newest
        .filter_map(|entry| changed(&entry.ok()?.path()))
        .max();
    // A new list is made only if sources changed, since it compiles everything once more.
    if changed(&list) > newest {
        return Ok(list);
    }
    let made = Path::new("kani-list.json");
    let _ = std::fs::remove_file(made);
    let mut command = Command::new("cargo");
    // `cargo kani list` has no options for package and target folder; it takes the package of the current folder.
    command
        // `cargo kani list` does not read the package's settings for runs, so the option for stubs is given here.
        .args(["kani", "list", "--format", "json", "-Z", "stubbing"])
        .current_dir("proofs")
        .env("CARGO_TARGET_DIR", target)
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    let _ = command
        .status()
        .map_err(|why| format!("cargo kani list: {why}"))?;
    let found = [Path::new("proofs/kani-list.json"), made];
    let found = found.into_iter().find(|path| path.is_file());
    let found = found.ok_or("`cargo kani list` left no list")?;
    std::fs::copy(found, &list).map_err(|why| format!("{}: {why}", list.display()))?;
    let _ = std::fs::remove_file(found);
    Ok(list)
}

/// Whether the named harness (proof) refutes the code in a workspace. Errors: the harness gave neither a proof nor a refutation.
pub fn refutes(workspace: &Path, target: &Path, harness: &str) -> Result<bool, String> {
    let left = run(workspace, target, Which::Named(harness), How::QUIET)?;
    let words = [
        "refuted".as_ref(),
        left.report.as_os_str(),
        harness.as_ref(),
    ];
    match inspect::ask(words).1 {
        Outcome::Ok(_) => Ok(true),
        Outcome::Failed(why) if why == "proved" => Ok(false),
        other => Err(other.reason().to_owned()),
    }
}

/// Prints a line for each harness (proof) as it ends, to show the progress. The verdicts come from the report, not from here.
fn show_progress(output: impl BufRead, show: bool) {
    // Several harnesses run at the same time; a line belongs to the thread that was named last.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// For tests: the reason that [`to_end`] returns if a shell script runs in the place of the checker and leaves no report.
    fn said(script: &str) -> String {
        let mut command = Command::new("sh");
        command
            .args(["-c", script])
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        to_end(&mut command, false).expect("sh runs")
    }

    #[test]
    fn a_checker_that_cannot_start_says_why() {
        let why = "echo '   Compiling x v1' >&2; echo 'Kani has no toolchain' >&2; exit 1";
        assert_eq!(said(why), "Kani has no toolchain");
        let panicked = "echo \"thread 'main' panicked at src/main.rs:3:5:\" >&2; echo 'no CBMC' >&2; \
                        echo 'note: run with RUST_BACKTRACE=1' >&2; exit 101";
        assert_eq!(
            said(panicked),
            "thread 'main' panicked at src/main.rs:3:5: no CBMC"
        );
        let loader =
            "echo 'warning: old' >&2; echo 'cargo-kani: error: no libz' >&2; echo more >&2";
        assert_eq!(said(loader), "cargo-kani: error: no libz");
        assert_eq!(
            said("echo first >&2; echo 'Error: second' >&2"),
            "Error: second"
        );
        assert_eq!(said("exit 3"), "it gave no reason; exit status: 3");
    }
}
