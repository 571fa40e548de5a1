//! Reads the lock: the committed list of harnesses, the proofs that the model checker runs. Each line has a harness and two hashes.
//! The first is of the harness's statement with everything that the statement uses in the proofs. The second is of the code that
//! the harness reaches.
//!
//! A weakened statement changes the first hash, a changed function the second. Comments, layout, tests and code that the harness
//! does not reach change neither.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::items::Items;
use super::shown::unshown;
use super::stands::{Ground, Numbers, PROOFS};

pub const LOCK: &str = "proofs/harnesses.lock";
/// Names and source folders of the crates; each crate comes after those that it depends on.
const CRATES: [(&str, &str); PROOFS + 1] = [
    ("touchstone_control", "control/src"),
    ("touchstone_protocol", "protocol/src"),
    ("touchstone_drive", "drive/src"),
    ("proofs", "proofs/src"),
];
/// Source file with arithmetic over `f32` and `f64`. It is left out, since the proofs do not enable its feature.
const NOT_BUILT: &str = "control/src/number/float.rs";
/// Line that identifies the package of fixed-point numbers in `Cargo.lock`. The package's version is a part of the hash of the
/// code.
const BUILT_WITH: &str = "name = \"fixed\"";

/// For each property (statement to prove) in the sources, the hashes of statement and code. The key is file and name, such as
/// `tdpa::p7_leaves`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Statements(BTreeMap<String, Numbers>);

/// Result of comparing a proof's line in the lock (the committed list of proofs) with the present sources.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// Statement and code are those with which the proof was run.
    Proved,
    /// The statement is the one that was proved, but the code has changed since.
    OtherCode,
    OtherStatement,
}

impl Statements {
    /// Hashes all properties in the workspace's sources. Errors: a file cannot be read, or an assertion has no cover (a statement
    /// that must be reached) that shows it to be reachable.
    pub fn read() -> Result<Self, String> {
        let mut files = Vec::new();
        for (rank, (_, folder)) in CRATES.iter().enumerate() {
            for path in sources(Path::new(folder))? {
                let text = read(&path)?;
                let unshown = if rank == PROOFS {
                    unshown(&text)?
                } else {
                    Vec::new()
                };
                if let Some(line) = unshown.first() {
                    return Err(format!(
                        "{}:{line}: no `cover!` is a statement after this assertion in its block, so nothing shows that it is reached: `assert_reached!`",
                        path.display()
                    ));
                }
                files.push((path, text));
            }
        }
        let lock = read(Path::new("Cargo.lock"))?;
        let package = lock.split("[[package]]").find(|it| it.contains(BUILT_WITH));
        Self::of(&files, package.unwrap_or_default())
    }

    /// Hashes the properties in files below the folders of [`CRATES`]. `built_with` is the text that names the version of the
    /// fixed-point numbers.
    fn of(files: &[(PathBuf, String)], built_with: &str) -> Result<Self, String> {
        let mut items = Items::default();
        for (path, text) in files {
            let of = CRATES
                .iter()
                .enumerate()
                .find(|(_, (_, folder))| path.starts_with(folder));
            let (rank, (name, folder)) = of.ok_or_else(|| path.display().to_string())?;
            let within = path.strip_prefix(folder).unwrap_or(path).with_extension("");
            let parts = within
                .iter()
                .map(|part| part.to_string_lossy().into_owned());
            let parts = parts.filter(|part| part != "mod" && part != "lib");
            items.add(
                rank,
                std::iter::once((*name).to_owned()).chain(parts).collect(),
                text,
            )?;
        }
        Ok(Self(Ground::of(&items).numbers(built_with)))
    }

    /// The hashes of an empty set of sources, for tests.
    #[cfg(test)]
    pub fn of_nothing() -> Self {
        Self(BTreeMap::new())
    }

    /// Line of the lock (list of proofs) for a harness such as `tdpa::w8::p7_leaves::proof`, with the hashes of the present
    /// sources.
    pub fn line(&self, harness: &str) -> String {
        let none = Numbers {
            statement: 0,
            code: 0,
        };
        let numbers = self.0.get(&property(harness)).unwrap_or(&none);
        format!("{harness} {:016x} {:016x}", numbers.statement, numbers.code)
    }

    /// Compares a proof's line of the lock (the committed list of proofs) with the present sources.
    pub fn standing(&self, line: &str) -> Standing {
        let now = self.line(name(line));
        let statement = |line: &str| line.rsplit_once(' ').map(|(it, _)| it.to_owned());
        if now == line {
            Standing::Proved
        } else if statement(&now) == statement(line) {
            Standing::OtherCode
        } else {
            Standing::OtherStatement
        }
    }
}

/// Name of the harness (proof) in a line of the lock, the committed list of proofs.
pub fn name(line: &str) -> &str {
    line.split(' ').next().unwrap_or_default()
}

/// File and name of the property that a harness (proof) proves: `tdpa::p7_leaves` for the harness `tdpa::w8::p7_leaves::proof`.
fn property(harness: &str) -> String {
    let parts: Vec<&str> = harness.trim_end_matches("::proof").split("::").collect();
    let (first, last) = (parts.first(), parts.last());
    format!("{}::{}", first.unwrap_or(&""), last.unwrap_or(&""))
}

fn read(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|why| format!("{}: {why}", path.display()))
}

fn sources(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let mut files = Vec::new();
    let mut left = vec![folder.to_owned()];
    while let Some(path) = left.pop() {
        let said = |why: std::io::Error| format!("{}: {why}", path.display());
        if path.is_dir() {
            for entry in std::fs::read_dir(&path).map_err(said)? {
                left.push(entry.map_err(said)?.path());
            }
        } else if path.extension().is_some_and(|end| end == "rs")
            && !path.ends_with("tests.rs")
            && path != Path::new(NOT_BUILT)
        {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

#[cfg(test)]
#[path = "lock_tests.rs"]
mod tests;
