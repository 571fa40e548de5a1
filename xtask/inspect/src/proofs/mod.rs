//! The gate of `cargo xtask prove`: checks in the model checker's report that each harness (proof) really proved its statement.
//!
//! The model checker also exits with 0 if there was nothing to prove, an assumption was impossible, or a cover was never reached.
//! (A cover is a statement that must be reachable.) So the gate requires: every harness of the committed list ran and succeeded, no
//! other ran, and every cover and every assertion of a property can be reached.

mod items;
mod lock;
mod memo;
mod properties;
mod report;
mod shown;
mod stands;
mod syntax;
mod table;
mod usage;

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use crate::answer::Answer;

use lock::{LOCK, Standing, Statements, name};
use report::Verdict;
use usage::Usage;

/// Most processor time of a harness (proof) in seconds, for all its tools and solvers together.
const PROCESSOR_S: f64 = 120.0;

/// Result files of a run of the model checker, and the limit of memory.
pub struct Run<'r> {
    /// Text of the model checker's report, in JSON.
    pub report: &'r str,
    /// Memory and processor time of each harness (proof), as text. A line has the name of the harness's file, kibibytes and
    /// seconds.
    pub usage: &'r str,
    /// Most memory that a harness (proof) may use, in KiB.
    pub memory_kib: u64,
    /// File with the results of earlier runs, to which the results of this run are added.
    pub memo: &'r Path,
}

impl Run<'_> {
    fn verdicts(&self) -> Result<BTreeMap<String, Verdict>, String> {
        let usage = usage::read(self.usage)?;
        let mut found = report::read(self.report)?;
        for verdict in found.values_mut() {
            verdict.usage = usage.get(verdict.program.as_str()).copied();
        }
        Ok(found)
    }

    /// Stores the harnesses (proofs) that succeeded within their limits of time and memory, so that a later run can resume.
    fn keep(
        &self,
        found: &BTreeMap<String, Verdict>,
        statements: &Statements,
    ) -> Result<(), String> {
        let wrong = wrong(found, self.memory_kib);
        let fine =
            |name: &str, _: &Verdict| !wrong.iter().any(|why| why.starts_with(&format!("{name}:")));
        memo::keep(self.memo, found, statements, fine)
    }
}

/// Checks the results of the harnesses (proofs) that ran because their names contain `part`. Does not compare with the committed
/// list.
pub fn some(run: &Run, part: &str) -> Result<Answer, String> {
    let found = run.verdicts()?;
    if found.is_empty() {
        return Err(format!("no harness has `{part}` in its name"));
    }
    run.keep(&found, &Statements::read()?)?;
    for (name, verdict) in &found {
        println!(
            "{:>7.1} s {:>6}  {name}: {}",
            verdict.seconds,
            megabytes(verdict),
            verdict.words()
        );
    }
    Ok(say(&found, wrong(&found, run.memory_kib)))
}

/// Prints those harnesses (proofs) of the model checker's list that are not yet proved for the present code and statements.
pub fn remaining(list: &str, memo: &Path) -> Result<Answer, String> {
    let statements = Statements::read()?;
    let known = memo::kept(memo, &statements);
    let held = held(&read_lock()?, &statements);
    let all = memo::listed(list)?;
    let left = all
        .iter()
        .filter(|name| !known.contains_key(*name) && !held.contains(*name));
    let mut count = 0;
    for name in left {
        println!("{name}");
        count += 1;
    }
    Ok(Answer::Right(format!(
        "{} of {} proved before",
        all.len() - count,
        all.len()
    )))
}

fn read_lock() -> Result<String, String> {
    std::fs::read_to_string(LOCK).map_err(|why| format!("{LOCK}: {why}"))
}

/// The harnesses (proofs) in the committed list whose hashes equal those of the present sources, so that they are still valid.
fn held(locked: &str, statements: &Statements) -> BTreeSet<String> {
    let lines = locked
        .lines()
        .filter(|line| statements.standing(line) == Standing::Proved);
    lines.map(|line| name(line).to_owned()).collect()
}

/// Checks the results of all harnesses (proofs) against the committed list (lock) and writes the table of results.
///
/// `words` describe the checker and its run time, `machine` describes how busy the machine was. With `bless`, the proved harnesses
/// are written into the lock. With `list`, the checker's own list of harnesses, results of earlier runs count, and every harness in
/// that list must be proved.
pub fn whole(
    run: &Run,
    words: &str,
    machine: &str,
    bless: bool,
    list: Option<&str>,
) -> Result<Answer, String> {
    let statements = Statements::read()?;
    let mut found = run.verdicts()?;
    run.keep(&found, &statements)?;
    let mut missing = Vec::new();
    let mut held = BTreeSet::new();
    if let Some(list) = list {
        let all = memo::listed(list)?;
        let before = memo::kept(run.memo, &statements).into_iter();
        for (name, verdict) in before.filter(|(name, _)| all.contains(name)) {
            found.entry(name).or_insert(verdict);
        }
        held = self::held(&read_lock()?, &statements);
        held.retain(|name| all.contains(name) && !found.contains_key(name));
        let not_there = all
            .iter()
            .filter(|name| !found.contains_key(*name) && !held.contains(*name));
        missing.extend(not_there.map(|name| format!("{name}: did not run")));
    }
    if bless {
        // The new lock has all proved harnesses. Harnesses of the old lock that are not proved now keep their old line, so that
        // they are reported.
        let proved = found.iter().filter(|(_, verdict)| verdict.proved());
        let mut lines: Vec<String> = proved.map(|(name, _)| statements.line(name)).collect();
        let before = std::fs::read_to_string(LOCK).unwrap_or_default();
        let is_there = |line: &str| found.get(name(line)).is_some_and(Verdict::proved);
        let old = before.lines().filter(|line| !is_there(line));
        lines.extend(old.map(str::to_owned));
        lines.sort();
        let lines: String = lines.into_iter().map(|line| line + "\n").collect();
        std::fs::write(LOCK, lines).map_err(|why| format!("{LOCK}: {why}"))?;
    }
    let mut wrong = wrong(&found, run.memory_kib);
    wrong.extend(missing);
    match read_lock() {
        Ok(locked) => wrong.extend(against_lock(&found, &held, &locked, &statements)),
        Err(why) => wrong.push(why),
    }
    let mut about = about(&found, words, machine);
    if !held.is_empty() {
        about += &format!(
            " {} more were proved of the same code before, by {LOCK}.",
            held.len()
        );
    }
    println!("{about}");
    if let Err(why) = table::write(&run.memo.with_file_name(table::NAME), &found, &about) {
        wrong.push(why);
    }
    Ok(say(&found, wrong))
}

/// A sentence for each harness (proof) that is not proved, or that exceeded its limit of processor time or memory.
fn wrong(found: &BTreeMap<String, Verdict>, most_memory_kib: u64) -> Vec<String> {
    let mut wrong = Vec::new();
    for (name, verdict) in found {
        if !verdict.proved() {
            wrong.push(format!("{name}: {}", verdict.words()));
        }
        // Without a measurement the wall-clock time is an upper bound of the processor time, since each process has one thread.
        let clock = Usage {
            processor_s: verdict.seconds,
            ..Usage::default()
        };
        let usage = verdict.usage.unwrap_or(clock);
        if usage.processor_s > PROCESSOR_S {
            wrong.push(format!(
                "{name}: {:.0} s of processor time, more than {PROCESSOR_S}",
                usage.processor_s
            ));
        }
        if usage.memory_kib > most_memory_kib {
            wrong.push(format!(
                "{name}: {}, more than {} MB",
                megabytes(verdict),
                most_memory_kib * 1024 / 1_000_000
            ));
        }
    }
    wrong
}

/// Differences from the committed list (lock): harnesses (proofs) of the lock that neither ran nor are in `held` (still valid by
/// their hashes), and harnesses that ran without being in the lock. Also lines of the lock that do not fit the sources.
fn against_lock(
    found: &BTreeMap<String, Verdict>,
    held: &BTreeSet<String>,
    locked: &str,
    statements: &Statements,
) -> Vec<String> {
    let names: Vec<&str> = locked.lines().map(name).collect();
    let missing = names
        .iter()
        .filter(|name| !found.contains_key(**name) && !held.contains(**name));
    let missing = missing.map(|name| format!("{name}: in {LOCK}, but did not run"));
    let new = found.keys().filter(|name| !names.contains(&name.as_str()));
    let new = new.map(|name| format!("{name}: ran, but is not in {LOCK} (--bless adds it)"));
    let changed = [Standing::OtherStatement, Standing::OtherCode]
        .into_iter()
        .flat_map(|standing| changed(locked, statements, standing));
    missing.chain(new).chain(changed).collect()
}

/// A sentence for each line of the committed list (lock) that differs from the present sources in the way that `standing` names.
fn changed(locked: &str, statements: &Statements, standing: Standing) -> Vec<String> {
    let lines = locked
        .lines()
        .filter(|line| statements.standing(line) == standing);
    let what = match standing {
        Standing::OtherCode => "reaches other code",
        _ => "states something else",
    };
    lines
        .map(|line| {
            format!(
                "{}: {what} than when it was proved (`prove --resume --bless` proves it again)",
                name(line)
            )
        })
        .collect()
}

/// Checks that every statement equals the one that was proved when the lock (the committed list of proofs) was written. Counts the
/// harnesses (proofs) whose code is unchanged too. This needs no run of the model checker, and so proves nothing new.
pub fn unchanged(locked: &str) -> Result<Answer, String> {
    let statements = Statements::read()?;
    let wrong = changed(locked, &statements, Standing::OtherStatement);
    let other = changed(locked, &statements, Standing::OtherCode);
    for line in wrong.iter().chain(&other) {
        println!("  {line}");
    }
    let all = locked.lines().count();
    Ok(if wrong.is_empty() {
        let of = all - other.len();
        Answer::Right(format!(
            "{all} statements are those of {LOCK}, {of} of them proved of this code"
        ))
    } else {
        Answer::Wrong(format!(
            "{} of {all} statements are not those of {LOCK}; {} reach other code",
            wrong.len(),
            other.len()
        ))
    })
}

fn say(found: &BTreeMap<String, Verdict>, wrong: Vec<String>) -> Answer {
    for line in &wrong {
        println!("  {line}");
    }
    let proved = found.values().filter(|verdict| verdict.proved()).count();
    let text = format!(
        "{proved} of {} harnesses proved, every cover of theirs reached",
        found.len()
    );
    if wrong.is_empty() && proved > 0 {
        Answer::Right(text)
    } else {
        Answer::Wrong(format!("{text}; {} faults, listed above", wrong.len()))
    }
}

fn megabytes(verdict: &Verdict) -> String {
    let mb = |usage: Usage| format!("{:.0} MB", usage.memory_kib as f64 * 1024.0 / 1e6);
    verdict.usage.map_or("-".into(), mb)
}

/// Text above the table of a whole run: numbers of proofs, processor time, memory, machine.
fn about(found: &BTreeMap<String, Verdict>, words: &str, machine: &str) -> String {
    let proved = found.values().filter(|verdict| verdict.proved()).count();
    let processor = found
        .values()
        .map(|verdict| verdict.usage.unwrap_or_default().processor_s);
    let longest = processor.clone().fold(0.0, f64::max);
    let largest = found
        .values()
        .max_by_key(|verdict| verdict.usage.unwrap_or_default().memory_kib);
    format!(
        "{proved} of {} harnesses proved with every cover reached and every assertion reachable; {words} \
         Processor time: {:.0} s in all harnesses together, {longest:.0} s in the\nlongest. Memory: at most {}. {machine}",
        found.len(),
        processor.sum::<f64>(),
        largest.map_or("-".into(), megabytes),
    )
}

/// Whether the model checker refuted exactly this harness (proof), by one of the harness's own assertions. The answer is "not run"
/// if it was neither proved nor refuted in this way.
pub fn refuted(report: &str, harness: &str) -> Result<Answer, String> {
    let found = match report::read(report) {
        Ok(found) => found,
        Err(why) => return Ok(Answer::NotRun(why)),
    };
    Ok(match is_refuted(&found, harness) {
        Ok(true) => Answer::Right("refuted".into()),
        Ok(false) => Answer::Wrong("proved".into()),
        Err(why) => Answer::NotRun(why),
    })
}

fn is_refuted(found: &BTreeMap<String, Verdict>, harness: &str) -> Result<bool, String> {
    let verdict = found.get(harness).ok_or("the harness did not run")?;
    if found.len() != 1 {
        return Err("more than one harness ran".into());
    }
    match &verdict.answer {
        report::Answer::Proved => Ok(false),
        // Only a failed assertion of the harness counts; an overflow that the checker finds in changed code does not.
        report::Answer::Refuted(_) if verdict.own_failed => Ok(true),
        _ => Err(verdict.words()),
    }
}

#[cfg(test)]
mod tests;
