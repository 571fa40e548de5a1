//! The copy of the code with all wrong changes in it, built once: what is in it, and its programs of tests.

use std::fs::OpenOptions;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use super::super::PARTS;
use crate::outcome::Outcome;
use crate::{changes, inspect, shell};

/// What is asked, the quick ones first.
const TESTED: [&str; 3] = [
    "touchstone-proofs",
    "touchstone-control",
    "touchstone-protocol",
];
/// Fewer samples than a release asks for, in the copy: where the code is right, the covers are reached far earlier.
const SHORTENED: [(&str, &str, &str); 3] = [
    (
        "proofs/src/source.rs",
        "TRIES: u64 = 20_000_000",
        "TRIES: u64 = 300_000",
    ),
    (
        "proofs/tests/spec_laws.rs",
        "TICKS: u64 = 1_500_000",
        "TICKS: u64 = 600_000",
    ),
    (
        "proofs/tests/spec_guard.rs",
        "ticks < 4_000_000",
        "ticks < 1_000_000",
    ),
];

/// One of the list.
pub struct Listed {
    pub number: usize,
    /// It can be chosen when the program runs.
    pub is_in: bool,
    pub row: String,
}

impl Listed {
    /// File and function.
    pub fn function(&self) -> String {
        self.row.split('\t').take(2).collect::<Vec<_>>().join(" ")
    }
}

pub fn folder() -> PathBuf {
    shell::target("systematic")
}

/// The copy with all changes in it that the compiler takes, built; and the list.
pub fn built(folder: &Path) -> Result<(PathBuf, Vec<Listed>), String> {
    std::fs::create_dir_all(folder).map_err(|why| format!("{}: {why}", folder.display()))?;
    let work = changes::copy(folder, &PARTS, &[])?;
    for (file, find, replace) in SHORTENED {
        let path = work.join(file);
        let text = std::fs::read_to_string(&path).map_err(|why| format!("{file}: {why}"))?;
        if text.matches(find).count() != 1 {
            return Err(format!("{file}: `{find}` is not there once"));
        }
        std::fs::write(&path, text.replace(find, replace)).map_err(|why| why.to_string())?;
    }
    let (without, messages) = (folder.join("refused.txt"), folder.join("messages.json"));
    let saved = folder.join("list.tsv");
    for _ in 0..40 {
        let list = written(&work, &without)?;
        // What was refused is so for these sources only.
        let rows: String = list
            .iter()
            .map(|one| format!("{}\t{}\n", one.number, one.row))
            .collect();
        if std::fs::read_to_string(&saved).is_ok_and(|before| before != rows) {
            let _ = std::fs::remove_file(&without);
            let _ = std::fs::remove_file(&saved);
            continue;
        }
        std::fs::write(&saved, &rows).map_err(|why| why.to_string())?;
        if build(&work, &messages)? {
            return Ok((work, list));
        }
        let words = [
            "operators".as_ref(),
            "refused".as_ref(),
            work.as_os_str(),
            messages.as_os_str(),
        ];
        let (lines, outcome) = inspect::ask(words);
        if !matches!(outcome, Outcome::Ok(_)) || lines.is_empty() {
            return Err(format!("the instrumented copy does not compile: {outcome}"));
        }
        eprintln!("{} changes are not Rust", lines.len());
        let mut file = OpenOptions::new()
            .create(true)
            .append(true)
            .open(&without)
            .map_err(|why| why.to_string())?;
        writeln!(file, "{}", lines.join("\n")).map_err(|why| why.to_string())?;
    }
    Err("the instrumented copy still does not compile".into())
}

/// The list alone, without a build; what the compiler refuses of it is not known then.
pub fn list(folder: &Path) -> Result<Vec<Listed>, String> {
    std::fs::create_dir_all(folder).map_err(|why| format!("{}: {why}", folder.display()))?;
    let work = changes::copy(folder, &PARTS, &[])?;
    written(&work, &folder.join("refused.txt"))
}

/// Writes the changes into a copy of the sources: the list.
fn written(work: &Path, without: &Path) -> Result<Vec<Listed>, String> {
    let words = [
        "operators".as_ref(),
        "instrument".as_ref(),
        work.as_os_str(),
        without.as_os_str(),
    ];
    match inspect::ask(words) {
        (lines, Outcome::Ok(_)) => Ok(listed(&lines)),
        (_, outcome) => Err(outcome.reason().into()),
    }
}

fn listed(lines: &[String]) -> Vec<Listed> {
    let one = |line: &String| {
        let mut words = line.splitn(3, '\t');
        Some(Listed {
            number: words.next()?.parse().ok()?,
            is_in: words.next()? == "on",
            row: words.next()?.to_owned(),
        })
    };
    lines.iter().filter_map(one).collect()
}

/// Whether it compiles; the compiler's messages are left in a file.
fn build(work: &Path, messages: &Path) -> Result<bool, String> {
    let file = std::fs::File::create(messages).map_err(|why| why.to_string())?;
    let mut cargo = shell::cargo("test");
    cargo
        .current_dir(work)
        .env("CARGO_TARGET_DIR", folder().join("target"))
        // As it ships: a check of a debug build that panics would hide what comes out, and refutes nothing.
        .env("CARGO_PROFILE_TEST_DEBUG_ASSERTIONS", "false")
        .env("CARGO_PROFILE_TEST_OVERFLOW_CHECKS", "false")
        .env("CARGO_PROFILE_DEV_DEBUG_ASSERTIONS", "false")
        .env("CARGO_PROFILE_DEV_OVERFLOW_CHECKS", "false")
        .args([
            "-q",
            "--no-run",
            "--message-format=json",
            "--lib",
            "--tests",
        ]);
    for package in TESTED {
        cargo.args(["-p", package]);
    }
    let status = cargo
        .stdout(file)
        .stderr(Stdio::null())
        .status()
        .map_err(|why| format!("cargo: {why}"))?;
    Ok(status.success())
}

/// The programs of the tests, by the package's order; from the compiler's messages.
pub fn binaries(work: &Path) -> Result<Vec<PathBuf>, String> {
    let messages = work.with_file_name("messages.json");
    let text = std::fs::read_to_string(&messages).map_err(|why| why.to_string())?;
    let mut found = Vec::new();
    for line in text.lines() {
        let Some((_, rest)) = line.split_once("\"executable\":\"") else {
            continue;
        };
        found.extend(rest.split_once('"').map(|(path, _)| PathBuf::from(path)));
    }
    if found.is_empty() {
        return Err("no program of tests was built".into());
    }
    let rank = |path: &PathBuf| {
        let name = path
            .file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let order = [
            "touchstone_proofs",
            "touchstone_control",
            "touchstone_protocol",
        ];
        let at = order.iter().position(|of| name.starts_with(of));
        (at.unwrap_or(order.len()), name)
    };
    found.sort_by_key(rank);
    Ok(found)
}
