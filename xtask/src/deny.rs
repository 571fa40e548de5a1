//! `cargo xtask deny`: checks the dependencies for crates in several versions, for licences and for known vulnerabilities
//! (`deny.toml`).
//!
//! Cargo alone finds crates in several versions; cargo-deny checks the rest. If cargo-deny is not installed or cannot fetch its
//! list of vulnerabilities, the step reports "not run" with the reason.

use std::collections::{BTreeMap, BTreeSet};

use crate::outcome::Outcome;
use crate::shell;

const INSTALL: &str = "licences and advisories: cargo install --locked cargo-deny";
/// Largest number of crates that may be in the dependency tree in more than one version. Some dependencies still need older
/// versions.
const MOST_TWICE: usize = 5;
/// Largest number of crates, this project's own included, of which the program `touchstone` may consist on this machine's platform.
const MOST_CRATES: usize = 160;
/// Message of cargo-deny when it cannot fetch the list of vulnerabilities.
const NO_LIST: &str = "failed to fetch advisory database";
/// Manifests whose dependencies are checked: the workspace's, and those of the separate workspaces for emulator, firmware and
/// microcontroller tests.
const MANIFESTS: [&str; 4] = [
    "Cargo.toml",
    "emulator/Cargo.toml",
    "firmware/Cargo.toml",
    "tests/thumb/Cargo.toml",
];

pub fn run(args: &[String]) -> Outcome {
    if !args.is_empty() {
        return Outcome::Usage("cargo xtask deny".into());
    }
    let mut tree = shell::cargo_locked("tree");
    tree.args(["--workspace", "--edges", "normal,build", "--prefix", "none"]);
    let Some(tree) = shell::capture(&mut tree) else {
        return Outcome::Failed("`cargo tree` failed".into());
    };
    let twice = twice(&tree);
    for (name, versions) in &twice {
        println!("{name}: {}", versions.join(", "));
    }
    if twice.len() > MOST_TWICE {
        return Outcome::Failed(format!(
            "{} crates stand twice in the tree, more than {MOST_TWICE}: cargo tree --duplicates",
            twice.len()
        ));
    }
    let mut program = shell::cargo_locked("tree");
    program.args([
        "--package",
        "touchstone",
        "--edges",
        "normal,build",
        "--prefix",
        "none",
    ]);
    let Some(program) = shell::capture(&mut program) else {
        return Outcome::Failed("`cargo tree` failed".into());
    };
    let crates = crates(&program);
    if crates > MOST_CRATES {
        return Outcome::Failed(format!(
            "the program consists of {crates} crates, more than {MOST_CRATES}: cargo tree --package touchstone"
        ));
    }
    let said = format!("{crates} crates in the program, {} twice", twice.len());
    if shell::capture(shell::cargo("deny").arg("--version")).is_none() {
        return Outcome::NotRun(format!("{said}; {INSTALL}"));
    }
    for manifest in MANIFESTS {
        match checked(manifest, &["licenses", "bans", "sources"]) {
            Outcome::Ok(_) => {}
            other => return other,
        }
    }
    let said = format!("{said}; licences hold");
    for manifest in MANIFESTS {
        match checked(manifest, &["advisories"]) {
            Outcome::Ok(_) => {}
            Outcome::NotRun(why) => return Outcome::NotRun(format!("{said}; {why}")),
            other => return other,
        }
    }
    Outcome::Ok(format!("{said}, and so do advisories"))
}

fn checked(manifest: &str, what: &[&str]) -> Outcome {
    let mut deny = shell::cargo("deny");
    // cargo-deny needs an absolute path; it rejects a bare file name.
    deny.arg("--manifest-path")
        .arg(shell::root().join(manifest));
    // cargo-deny looks for deny.toml in the manifest's folder and above. The option --config is not used, because its place differs
    // between versions.
    deny.arg("check").args(what);
    let mut could_look = true;
    match shell::run_reading_all(&mut deny, |line| could_look &= !line.contains(NO_LIST)) {
        Outcome::Failed(_) if !could_look => {
            Outcome::NotRun("the list of advisories could not be fetched".into())
        }
        outcome => outcome,
    }
}

/// Number of crates that `cargo tree` lists.
fn crates(tree: &str) -> usize {
    let names = tree.lines().filter_map(|line| {
        let mut words = line.split_whitespace();
        Some((words.next()?, words.next()?))
    });
    names.collect::<BTreeSet<_>>().len()
}

/// The crates of which `cargo tree` lists several versions, with the versions. A line of the text `tree` is such as `syn v2.0.119
/// (proc-macro)`.
fn twice(tree: &str) -> Vec<(String, Vec<String>)> {
    let mut versions: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for line in tree.lines() {
        let mut words = line.split_whitespace();
        if let (Some(name), Some(version)) = (words.next(), words.next()) {
            versions.entry(name).or_default().insert(version);
        }
    }
    versions.retain(|_, versions| versions.len() > 1);
    let owned = |versions: BTreeSet<&str>| versions.into_iter().map(str::to_owned).collect();
    versions
        .into_iter()
        .map(|(name, versions)| (name.to_owned(), owned(versions)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_versions_are_twice_and_one_that_is_named_twice_is_not() {
        let tree = "touchstone v0.1.0 (/here)\nsyn v2.0.1 (proc-macro)\nquote v1.0.0\n\nsyn v3.0.0\nquote v1.0.0 (*)\n";
        assert_eq!(crates(tree), 4);
        let found = twice(tree);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].0, "syn");
        assert_eq!(found[0].1, ["v2.0.1", "v3.0.0"]);
    }
}
