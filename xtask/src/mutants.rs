//! `cargo xtask prove --mutants`: small wrong changes to the law, each of which a named proof must refute, and, with `--tests`,
//! a named test as well.
//!
//! A mutant is caught when the harness that it names ran alone and an assertion in it failed. A change that does not compile,
//! a time-out, a cover that is no longer reached: none of these is a catch.

use std::path::Path;
use std::time::Instant;

use crate::copy::{self, Change};
use crate::outcome::Outcome;
use crate::{prove, shell};

const LIST: &str = "proofs/mutants.toml";
/// What the proofs are made of; nothing else has to build.
const PARTS: [&str; 4] = ["control", "protocol", "drive", "proofs"];
/// Of all mutants, in per cent.
const CAUGHT: usize = 95;
const LEAST: usize = 30;

/// One `[[mutant]]`: plain `key = 'value'` lines.
#[derive(Debug, Default, Clone)]
struct Mutant {
    change: Change,
    /// The harness that refutes it.
    harness: String,
    /// The test that fails of it, `package name`; may be empty.
    test: String,
}

fn list(text: &str) -> Vec<Mutant> {
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
            "file" => mutant.change.file = value.into(),
            "find" => mutant.change.find = value.into(),
            "replace" => mutant.change.replace = value.into(),
            "harness" => mutant.harness = value.into(),
            "test" => mutant.test = value.into(),
            _ => {}
        }
    }
    mutants
}

/// Goes through the list; prints a line for each.
fn each(
    folder: &Path,
    of: &str,
    named: impl Fn(&Mutant) -> &str,
    ask: impl Fn(&Path, &Mutant) -> Result<bool, String>,
) -> Outcome {
    let text = std::fs::read_to_string(LIST).unwrap_or_default();
    let mutants: Vec<_> = list(&text)
        .into_iter()
        .filter(|mutant| !named(mutant).is_empty())
        .collect();
    if mutants.len() < LEAST {
        return Outcome::Failed(format!(
            "{LIST} has {} mutants with a {of}, fewer than {LEAST}",
            mutants.len()
        ));
    }
    let work = match copy::copy(folder, &PARTS, &[]) {
        Ok(work) => work,
        Err(why) => return Outcome::Failed(why),
    };
    let mut caught = 0;
    for (number, mutant) in mutants.iter().enumerate() {
        let begun = Instant::now();
        let changes = std::slice::from_ref(&mutant.change);
        let answer = copy::with(&work, changes, || ask(&work, mutant));
        let word = match &answer {
            Ok(true) => "caught".into(),
            Ok(false) => "MISSED".into(),
            Err(why) => format!("NO ANSWER: {why}"),
        };
        caught += usize::from(answer == Ok(true));
        println!(
            "{:>3} {:>5.0} s  {word}  {}  `{}` -> `{}`",
            number + 1,
            begun.elapsed().as_secs_f64(),
            named(mutant),
            mutant.change.find,
            mutant.change.replace
        );
    }
    let text = format!("{caught} of {} mutants caught by a {of}", mutants.len());
    if caught * 100 >= mutants.len() * CAUGHT {
        Outcome::Ok(text)
    } else {
        Outcome::Failed(format!("{text}, at least {CAUGHT} % wanted"))
    }
}

/// Each mutant against the proof that it names.
pub fn by_proofs() -> Outcome {
    let folder = shell::target("mutants-by-proofs");
    let target = folder.join("kani");
    each(
        &folder,
        "proof",
        |mutant| &mutant.harness,
        |work, mutant| prove::refutes(work, &target, &mutant.harness),
    )
}

/// Each mutant against the test that it names, without the checker.
pub fn by_tests() -> Outcome {
    let folder = shell::target("mutants-by-tests");
    let target = folder.join("tests");
    each(
        &folder,
        "test",
        |mutant| &mutant.test,
        |work, mutant| {
            let (package, name) = mutant
                .test
                .split_once(' ')
                .ok_or("a test is `package name`")?;
            // Built apart from run, so that what does not compile is not taken for a catch.
            let cargo = |more: &[&str]| {
                let mut cargo = shell::cargo("test");
                cargo
                    .current_dir(work)
                    .env("CARGO_TARGET_DIR", &target)
                    .args(["-q", "-p", package]);
                cargo.args(more).output().map_err(|why| why.to_string())
            };
            if !cargo(&["--no-run"])?.status.success() {
                return Err("does not compile".into());
            }
            let done = cargo(&["--", "--exact", name])?;
            let output = String::from_utf8_lossy(&done.stdout).into_owned();
            let ran = |what: &str| {
                output
                    .lines()
                    .any(|line| line.contains(&format!(" 1 {what}")))
            };
            match (done.status.success(), ran("failed"), ran("passed")) {
                (false, true, false) => Ok(true),
                (true, false, true) => Ok(false),
                _ => Err(format!("`{name}` did not run alone")),
            }
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each change of the list applies, changes something, and names a harness that exists.
    #[test]
    fn the_list_fits_the_sources() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        let read = |path: &str| std::fs::read_to_string(root.join(path)).expect("readable");
        let (mutants, locked) = (list(&read(LIST)), read("proofs/harnesses.lock"));
        assert!(mutants.len() >= LEAST);
        for mutant in &mutants {
            assert_eq!(mutant.change.fits(&read(&mutant.change.file)), Ok(()));
            assert_ne!(mutant.change.find, mutant.change.replace);
            assert!(
                locked.lines().any(|name| name == mutant.harness),
                "{mutant:?}"
            );
        }
        assert_eq!(mutants.len(), read(LIST).matches("[[mutant]]").count());
    }
}
