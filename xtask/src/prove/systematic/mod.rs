//! `cargo xtask prove --mutants --systematic`: every wrong change that our operators make, asked of the tests, one after the other.
//!
//! The code is built once with all changes in it (`inspect/src/operators/`), and the number of the one that is on stands in the
//! environment. A change is refuted when an assertion of a property or a test fails: not by a panic of the code itself, nor by a cover
//! that is no longer reached, nor by the time. What was found is written down at once, so that a run can be broken off and taken up
//! again, and several can share the list (`--shard 1/8`). One of each function comes first, then the second of each, and so on, so that
//! a run that is broken off has been everywhere. With `--proofs` the checker is asked ([`proofs`]), with a name of those harnesses only, with `--every`
//! the properties of which all inputs are tried ([`every`]).

mod every;
mod instrumented;
mod proofs;

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use crate::outcome::Outcome;
use crate::{inspect, shell};
use instrumented::{Listed, binaries, built, folder};

/// The committed list, with what became of each.
const LIST: &str = "proofs/systematic.tsv";
/// A refutation that another command found, of code that only another machine runs: set in the list by hand, as an argument is.
const BY_HAND: &str = "cargo xtask ";
/// How many are asked again with the tests.
const SAMPLE: usize = 16;
/// A program of tests that takes more processor time, in seconds, has no answer.
const MOST_S: u32 = 60;
/// Where the tests of a source are likely to be: those are asked first.
const LIKELY: [(&str, &[&str]); 18] = [
    ("law/tdpa", &["tdpa"]),
    ("law/fba", &["fba"]),
    ("law/sfa", &["sfa"]),
    ("law/spring", &["spring"]),
    ("law/enhanced", &["enhanced", "p11_", "offset"]),
    ("filter", &["enhanced", "p11_"]),
    ("control/src/guard", &["guard", "stage"]),
    ("estimator", &["estimator"]),
    ("number/wide", &["wide"]),
    ("number", &["edges", "facts", "estimator"]),
    ("magnitude", &["heart", "edges", "every"]),
    ("reciprocal", &["reciprocal", "facts"]),
    ("space/guard", &["space"]),
    ("space", &["space"]),
    ("controller", &["controller::", "p8_"]),
    ("coefficients", &["set_laws", "p8_"]),
    ("observer", &["observer", "views", "tdpa"]),
    ("machine", &["device", "machine"]),
];

/// A part of the list: the `index`th of `of`, from 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shard {
    pub index: usize,
    pub of: usize,
}

impl Shard {
    pub const ALL: Self = Self { index: 1, of: 1 };

    /// Whether it has the one with this number.
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

/// Who is asked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Asked<'a> {
    Tests,
    /// Those with this in their names.
    Proofs(&'a str),
    Every,
}

/// Whether a proof refuted it, by the checker or on all inputs.
fn is_proof(outcome: &str) -> bool {
    outcome.ends_with("::proof") || outcome.ends_with("::every")
}

/// The command.
pub fn run(shard: Shard, of: Asked) -> Outcome {
    let done = match of {
        Asked::Tests => asked(shard),
        Asked::Proofs(part) => proofs::asked(shard, part),
        Asked::Every => every::asked(shard),
    };
    match done {
        Ok(()) => inspect::call([
            "operators".as_ref(),
            "table".as_ref(),
            folder().join("outcomes.tsv").as_os_str(),
        ]),
        Err(why) => Outcome::Failed(why),
    }
}

/// A few of those that the committed list says were refuted, each of which the test that it names must refute again.
pub fn sample() -> Outcome {
    match sampled() {
        Ok((refuted, all)) if refuted == all && all > 0 => Outcome::Ok(format!(
            "{refuted} of {all} sampled wrong changes refuted again"
        )),
        Ok((refuted, all)) => {
            Outcome::Failed(format!("{refuted} of {all} sampled wrong changes refuted"))
        }
        Err(why) => Outcome::Failed(why),
    }
}

fn sampled() -> Result<(usize, usize), String> {
    let text = std::fs::read_to_string(shell::root().join(LIST))
        .map_err(|why| format!("{LIST}: {why}"))?;
    let known: Vec<(&str, &str)> = text
        .lines()
        .filter_map(|line| line.rsplit_once('\t'))
        .filter_map(|(row, outcome)| Some((row, outcome.strip_prefix("refuted: ")?)))
        // What a proof refuted may be one that no test finds.
        .filter(|(_, by)| !is_proof(by) && !by.starts_with(BY_HAND))
        .collect();
    let (work, list) = built(&folder())?;
    let binaries = binaries(&work)?;
    let (mut refuted, mut all) = (0, 0);
    for (row, test) in known.iter().step_by((known.len() / SAMPLE).max(1)) {
        // A change that the sources no longer have is asked of nobody.
        let Some(one) = list.iter().find(|one| one.is_in && one.row == *row) else {
            continue;
        };
        all += 1;
        let mut found = false;
        for binary in &binaries {
            let (_, failed) = failures(
                binary,
                one.number,
                &["--exact", test],
                Some(&BTreeSet::new()),
            )?;
            found |= !failed.is_empty();
        }
        if !found {
            println!("not refuted by {test}: {}", row.replace('\t', " "));
        }
        refuted += usize::from(found);
    }
    Ok((refuted, all))
}

/// What became of each so far: its row and the word, of the committed list and of runs since.
struct Outcomes {
    file: File,
    known: BTreeMap<String, String>,
}

impl Outcomes {
    fn open() -> Result<Self, String> {
        let path = folder().join("outcomes.tsv");
        let committed = std::fs::read_to_string(shell::root().join(LIST)).unwrap_or_default();
        let since = std::fs::read_to_string(&path).unwrap_or_default();
        let known = committed
            .lines()
            .skip(1)
            .chain(since.lines())
            .filter_map(|line| line.rsplit_once('\t'))
            .filter(|(_, outcome)| *outcome != "not run")
            .map(|(row, outcome)| (row.to_owned(), outcome.to_owned()))
            .collect();
        let file = OpenOptions::new()
            .create(true)
            .append(true)
            .open(&path)
            .map_err(|why| format!("{}: {why}", path.display()))?;
        Ok(Self { file, known })
    }

    fn of(&self, one: &Listed) -> Option<&str> {
        self.known.get(&one.row).map(String::as_str)
    }

    /// Writes it down at once, and says so.
    fn keep(&mut self, one: &Listed, outcome: String, seconds: f64) -> Result<(), String> {
        writeln!(self.file, "{}\t{outcome}", one.row)
            .map_err(|why| format!("outcomes.tsv: {why}"))?;
        let row = one.row.replace('\t', " ");
        println!("{:>5} {seconds:>5.1} s  {outcome}  {row}", one.number);
        self.known.insert(one.row.clone(), outcome);
        Ok(())
    }
}

/// One change of each function, then the second of each, and so on.
fn in_turns(list: &mut [Listed]) {
    let mut of_function = BTreeMap::<String, usize>::new();
    list.sort_by_cached_key(|one| {
        let before = of_function.entry(one.function()).or_default();
        *before += 1;
        (*before, one.number)
    });
}

fn asked(shard: Shard) -> Result<(), String> {
    let (work, mut list) = built(&folder())?;
    let mut binaries = binaries(&work)?;
    let noise = noise(&mut binaries)?;
    let mut outcomes = Outcomes::open()?;
    in_turns(&mut list);
    for one in list.iter().filter(|one| shard.has(one.number)) {
        if outcomes.of(one).is_some() {
            continue;
        }
        let begun = Instant::now();
        let outcome = match one.is_in {
            true => by_tests(one, &binaries, &noise)?,
            false => "not Rust".into(),
        };
        outcomes.keep(one, outcome, begun.elapsed().as_secs_f64())?;
    }
    Ok(())
}

/// Tests that fail where no change is on, as fewer samples do not reach all their covers: they refute nothing. Afterwards the quickest
/// program comes first.
fn noise(binaries: &mut [PathBuf]) -> Result<BTreeSet<String>, String> {
    let (mut found, mut took) = (BTreeSet::new(), BTreeMap::new());
    for binary in binaries.iter() {
        let begun = Instant::now();
        for failure in failures(binary, 0, &[], None)?.1 {
            found.insert(failure);
        }
        let name = binary.file_name().unwrap_or_default().to_string_lossy();
        eprintln!(
            "{name}: {:.1} s without a change",
            begun.elapsed().as_secs_f64()
        );
        took.insert(binary.clone(), begun.elapsed());
    }
    binaries.sort_by_key(|binary| took.get(binary).copied());
    eprintln!("left out, as they fail without a change: {found:?}");
    Ok(found)
}

fn by_tests(
    one: &Listed,
    binaries: &[PathBuf],
    noise: &BTreeSet<String>,
) -> Result<String, String> {
    let likely = LIKELY.iter().find(|(file, _)| one.row.contains(file));
    let likely = likely.map_or(&[][..], |(_, words)| words);
    let mut ended = true;
    for words in [likely, &[]] {
        if words.is_empty() && !ended {
            // What did not end at the likely place will not elsewhere.
            break;
        }
        for binary in binaries {
            let (end, refuted) = failures(binary, one.number, words, Some(noise))?;
            if let Some(name) = refuted.first() {
                return Ok(format!("refuted: {name}"));
            }
            ended &= end;
        }
    }
    Ok(if ended {
        "survived".into()
    } else {
        "no end".into()
    })
}

/// Runs a program of tests with one change on: whether it came to its end, and the tests of which an assertion failed. With names to
/// leave out it ends at the first other one.
fn failures(
    binary: &Path,
    number: usize,
    words: &[&str],
    leave_out: Option<&BTreeSet<String>>,
) -> Result<(bool, Vec<String>), String> {
    let mut command = Command::new(binary);
    command
        .args(["--test-threads=1", "--nocapture"])
        .args(words)
        .env("TOUCHSTONE_MUTANT", number.to_string())
        .env("RUST_BACKTRACE", "0")
        // Where the tests find the sources.
        .current_dir(folder().join("work/proofs"));
    let mut child = shell::within(&command, MOST_S)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|why| format!("{}: {why}", binary.display()))?;
    let errors = child.stderr.take().ok_or("no standard error")?;
    let mut found = Vec::new();
    // The line after the place says what failed.
    let mut of: Option<String> = None;
    for line in BufReader::new(errors).lines().map_while(Result::ok) {
        if let Some(name) = of.take()
            && !line.contains("covers never reached")
            && leave_out.is_none_or(|names| !names.contains(&name))
        {
            found.push(name);
            if leave_out.is_some() {
                break;
            }
        }
        of = place(&line);
    }
    let _ = child.kill();
    let status = child.wait().map_err(|why| why.to_string())?;
    // A signal that is not ours: it took too long.
    Ok((status.code().is_some(), found))
}

/// The test whose own assertion panicked: `thread 'tdpa::w8::p7_leaves::sampled' (7) panicked at proofs/src/tdpa.rs:9:1:`.
fn place(line: &str) -> Option<String> {
    let (name, rest) = line.strip_prefix("thread '")?.split_once('\'')?;
    let (_, place) = rest.split_once("panicked at ")?;
    let is_test = name.contains("::tests::")
        || !place.contains("control/src/") && !place.contains("protocol/src/");
    // A number format that finds its facts broken is no property.
    let own = is_test && !place.contains("facts.rs:") || place.contains("/tests/");
    own.then(|| name.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shard_is_a_part_of_the_list() {
        assert_eq!(Shard::read("2/8"), Some(Shard { index: 2, of: 8 }));
        assert!(
            ["0/8", "9/8", "x/8", "3"]
                .into_iter()
                .all(|text| Shard::read(text).is_none())
        );
    }

    #[test]
    fn only_an_assertion_of_a_property_or_a_test_refutes() {
        let of = |place_of: &str| {
            place(&format!(
                "thread 'tdpa::w8::p7_leaves::sampled' (7) panicked at {place_of}:9:1:"
            ))
        };
        assert_eq!(
            of("proofs/src/tdpa.rs").as_deref(),
            Some("tdpa::w8::p7_leaves::sampled")
        );
        assert_eq!(
            of("proofs/tests/spec_laws.rs").as_deref(),
            Some("tdpa::w8::p7_leaves::sampled")
        );
        assert_eq!(of("control/src/number/fixed_point.rs"), None);
        assert_eq!(of("proofs/src/facts.rs"), None);
        let own =
            "thread 'reciprocal::tests::all' (7) panicked at control/src/reciprocal.rs:120:9:";
        assert_eq!(place(own).as_deref(), Some("reciprocal::tests::all"));
        assert_eq!(place("test tdpa::w8::p7_leaves::sampled ... ok"), None);
    }
}
