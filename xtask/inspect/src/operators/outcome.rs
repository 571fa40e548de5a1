//! What became of each wrong change: the committed list, and a table of functions made of it.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use super::listed;
use crate::answer::Answer;

/// Every change with what became of it; that something is equivalent stands there by hand, with why.
const LIST: &str = "proofs/systematic.tsv";
const TABLE: &str = "proofs/systematic.md";
const HEAD: &str = "file\tfunction\toperator\tordinal\twas\tinstead\toutcome (written by `cargo xtask prove --mutants --systematic`)\n";

/// What a row says of itself, and what became of it.
fn split(line: &str) -> Option<(String, String)> {
    let (row, outcome) = line.rsplit_once('\t')?;
    Some((row.to_owned(), outcome.to_owned()))
}

/// Of one function.
#[derive(Default)]
struct Counts {
    all: usize,
    refuted: usize,
    survived: usize,
    equivalent: usize,
    /// No build of it.
    none: usize,
    /// Neither refuted nor not within the time.
    open: usize,
    by: BTreeMap<String, usize>,
}

impl Counts {
    fn add(&mut self, outcome: &str) {
        let is = |word: &str| outcome.starts_with(word);
        self.all += 1;
        let count = if is("refuted") {
            &mut self.refuted
        } else if is("survived") {
            &mut self.survived
        } else if is("equivalent") {
            &mut self.equivalent
        } else if is("not Rust") {
            &mut self.none
        } else {
            &mut self.open
        };
        *count += 1;
        if let Some(by) = outcome.strip_prefix("refuted: ") {
            *self
                .by
                .entry(by.split(' ').next().unwrap_or_default().to_owned())
                .or_default() += 1;
        }
    }

    /// Whether a proof refuted one, by the checker or on all inputs.
    fn by_a_proof(&self) -> bool {
        self.by
            .keys()
            .any(|by| by.ends_with("::proof") || by.ends_with("::every"))
    }

    fn cells(&self) -> String {
        let Self {
            all,
            refuted,
            survived,
            equivalent,
            none,
            open,
            ..
        } = self;
        format!("{all} | {refuted} | {survived} | {equivalent} | {none} | {open}")
    }

    /// What refuted most of them.
    fn most(&self) -> String {
        let mut by: Vec<_> = self.by.iter().collect();
        by.sort_by_key(|(name, count)| (usize::MAX - **count, (*name).clone()));
        let names: Vec<String> = by
            .iter()
            .take(3)
            .map(|(name, _)| format!("`{name}`"))
            .collect();
        names.join(", ")
    }
}

/// Takes up what a run wrote down, and writes list and table anew. A change that the sources no longer have is left out.
pub fn table(outcomes: &Path) -> Result<Answer, String> {
    let old = std::fs::read_to_string(LIST).unwrap_or_default();
    let new = std::fs::read_to_string(outcomes).unwrap_or_default();
    let mut known: BTreeMap<String, String> = old.lines().skip(1).filter_map(split).collect();
    for (row, outcome) in new.lines().filter_map(split) {
        // What was argued or refuted by hand stays, unless a test refuted it after all.
        let argued = known
            .get(&row)
            .is_some_and(|it| it.starts_with("equivalent") || it.starts_with("refuted: cargo "));
        if !argued || outcome.starts_with("refuted") {
            known.insert(row, outcome);
        }
    }
    let (mut list, mut functions) = (HEAD.to_owned(), BTreeMap::<(String, String), Counts>::new());
    let mut all = Counts::default();
    for one in listed()? {
        let row = one.row();
        let outcome = known.get(&row).map_or("not run", String::as_str);
        let _ = writeln!(list, "{row}\t{outcome}");
        all.add(outcome);
        let function = (one.file.clone(), one.wrong.function.clone());
        functions.entry(function).or_default().add(outcome);
    }
    std::fs::write(LIST, list).map_err(|why| format!("{LIST}: {why}"))?;
    let text = page(&all, &functions);
    std::fs::write(TABLE, text).map_err(|why| format!("{TABLE}: {why}"))?;
    let without = functions.values().filter(|of| of.refuted == 0).count();
    let proofs = functions.values().filter(|of| of.by_a_proof()).count();
    Ok(Answer::Right(format!(
        "{} wrong changes: {} refuted, {} survived, {} equivalent, {} not Rust, {} open; of {} functions {proofs} have one that a \
         proof refuted, and {without} none that was refuted",
        all.all,
        all.refuted,
        all.survived,
        all.equivalent,
        all.none,
        all.open,
        functions.len()
    )))
}

fn page(all: &Counts, functions: &BTreeMap<(String, String), Counts>) -> String {
    let mut text = String::from(INTRODUCTION);
    let _ = writeln!(text, "| all | {} | |", all.cells());
    let mut file = "";
    for ((of, function), counts) in functions {
        if of != file {
            file = of;
            let _ = writeln!(text, "\n**`{file}`**\n\n{COLUMNS}");
        }
        let _ = writeln!(
            text,
            "| `{function}` | {} | {} |",
            counts.cells(),
            counts.most()
        );
    }
    text
}

const COLUMNS: &str = "| function | changes | refuted | survived | equivalent | not Rust | open | refuted by (most) |\n\
                       |---|---:|---:|---:|---:|---:|---:|---|";
const INTRODUCTION: &str = "# Wrong changes by rule\n\n\
Every place of the law's code where one of our operators applies: comparisons, signs, sums, `min` and `max`, roundings, constants,\n\
decisions, statements dropped, bodies that return at once ([the operators](../xtask/inspect/src/operators/find.rs)); the float reference is left out. \"Refuted\" names the\n\
harness whose property failed, or the test, on samples (`sampled`), under the checker (`proof`) or on all inputs at 8 bits (`every`); an overflow or a time-out is not one.\n\
\"Open\": not run, or no answer. The list itself, with why what is called equivalent is: [`systematic.tsv`](systematic.tsv).\n\n\
Written by `cargo xtask prove --mutants --systematic`.\n\n\
| function | changes | refuted | survived | equivalent | not Rust | open | refuted by (most) |\n\
|---|---:|---:|---:|---:|---:|---:|---|\n";
