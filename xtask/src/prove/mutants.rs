//! `cargo xtask prove --mutants`: mutation tests. Each mutant is a small wrong change of the code, and its entry in the list
//! names a proof, a test, or both. The proof must refute the changed code. With `--tests`, the named test must fail instead.
//!
//! A mutant is caught when the named proof (harness) ran alone and one of its assertions failed. A change that does not compile, a
//! time-out or an unreachable cover is not a catch.
//!
//! Each result is stored at once and not repeated for the same sources, so that a run can be interrupted. `--shard I/N` tests one
//! of N parts of the list. A proof has the limits of the checker for time and memory; a test has a limit of processor time.

use std::path::Path;
use std::time::Instant;

use super::{PARTS, checker};
use crate::changes::{self, Entry};
use crate::memo::Memo;
use crate::outcome::Outcome;
use crate::shell;

const LIST: &str = "proofs/mutants.toml";
const LEAST: usize = 30;
/// Most processor time of a test, in seconds.
const TEST_S: u32 = 300;

/// One of several parts of the list of mutants (wrong changes): part `index`, counted from 1, of `of` parts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shard {
    pub index: usize,
    pub of: usize,
}

impl Shard {
    pub const ALL: Self = Self { index: 1, of: 1 };

    /// Whether this part of the list contains the mutant (wrong change) with this number.
    pub fn has(self, number: usize) -> bool {
        number % self.of == self.index % self.of
    }

    pub fn read(text: &str) -> Option<Self> {
        let (index, of) = text.split_once('/')?;
        let shard = Self {
            index: index.parse().ok()?,
            of: of.parse().ok()?,
        };
        (shard.index >= 1 && shard.index <= shard.of).then_some(shard)
    }
}

/// Runs `ask` for each mutant (wrong change) of the part `shard` and prints a line for each. `of` is the field of an entry that
/// names the mutant's proof or test.
fn each(
    folder: &Path,
    of: &str,
    shard: Shard,
    ask: impl Fn(&Path, &str) -> Result<bool, String>,
) -> Outcome {
    let named = |mutant: &Entry| mutant.word(of).to_owned();
    let mut mutants = match changes::list(LIST) {
        Ok(mutants) => mutants,
        Err(outcome) => return outcome,
    };
    mutants.retain(|mutant| !named(mutant).is_empty());
    if mutants.len() < LEAST {
        return Outcome::Failed(format!(
            "{LIST} has {} mutants with a {of}, fewer than {LEAST}",
            mutants.len()
        ));
    }
    let work = match changes::copy(folder, &PARTS, &[]) {
        Ok(work) => work,
        Err(why) => return Outcome::Failed(why),
    };
    let memo = Memo::open(folder.join("found.tsv"), &work, None);
    let mut memo = match memo {
        Ok(memo) => memo,
        Err(why) => return Outcome::Failed(format!("{}: {why}", folder.display())),
    };
    let (mut caught, mut all) = (0, 0);
    for (number, mutant) in mutants.iter().enumerate() {
        if !shard.has(number + 1) {
            continue;
        }
        all += 1;
        let begun = Instant::now();
        let key = memo.key(mutant);
        let known = memo.get(key).map(|(word, _)| word == "caught");
        let answer = match known {
            Some(caught) => Ok(caught),
            None => changes::with(&work, &mutant.changes, || ask(&work, &named(mutant))),
        };
        let word = match &answer {
            Ok(true) => "caught".into(),
            Ok(false) => "MISSED".into(),
            Err(why) => format!("NO ANSWER: {why}"),
        };
        caught += usize::from(answer == Ok(true));
        // A mutant without a result is tested again in the next run.
        if known.is_none()
            && answer.is_ok()
            && let Err(why) = memo.keep(key, &word, "")
        {
            return Outcome::Failed(format!("what was found cannot be kept: {why}"));
        }
        println!(
            "{:>3} {:>5.0} s  {word}  {}  `{}` -> `{}`",
            number + 1,
            begun.elapsed().as_secs_f64(),
            named(mutant),
            mutant.changes[0].find,
            mutant.changes[0].replace
        );
    }
    let text = format!("{caught} of {all} mutants caught by a {of}");
    if caught == all {
        Outcome::Ok(text)
    } else {
        Outcome::Failed(format!("{text}, all wanted"))
    }
}

/// Tests each mutant (wrong change) with the proof that its entry names.
pub fn by_proofs(shard: Shard) -> Outcome {
    let folder = shell::target("mutants-by-proofs");
    let target = folder.join("kani");
    each(&folder, "harness", shard, |work, harness| {
        checker::refutes(work, &target, harness)
    })
}

/// Tests each mutant (wrong change) with the unit test that its entry names, without the model checker.
pub fn by_tests(shard: Shard) -> Outcome {
    let folder = shell::target("mutants-by-tests");
    let target = folder.join("tests");
    each(&folder, "test", shard, |work, test| {
        let (package, name) = test.rsplit_once(' ').ok_or("a test is `package name`")?;
        // Compiles before it runs, so that a failure to compile does not count as a catch.
        let cargo = |more: &[&str]| {
            let mut cargo = shell::cargo("test");
            cargo
                .current_dir(work)
                .env("CARGO_TARGET_DIR", &target)
                .args(["-q", "-p"])
                .args(package.split(' '));
            cargo.args(more);
            cargo
        };
        let said = |why: std::io::Error| why.to_string();
        let built = cargo(&["--no-run"]).output().map_err(said)?;
        if !built.status.success() {
            return Err("does not compile".into());
        }
        let test = cargo(&["--", "--exact", name]);
        let done = shell::within(&test, TEST_S).output().map_err(said)?;
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
    })
}

#[cfg(test)]
mod tests {
    use super::Shard;

    #[test]
    fn a_shard_is_a_part_of_the_list() {
        assert_eq!(Shard::read("2/8"), Some(Shard { index: 2, of: 8 }));
        assert!(
            ["0/8", "9/8", "x/8", "3"]
                .into_iter()
                .all(|text| Shard::read(text).is_none())
        );
    }
}
