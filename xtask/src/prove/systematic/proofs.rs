//! `--mutants --systematic --proofs`: the wrong changes by rule, asked of the checker.
//!
//! First, of each function, changes that a test refuted, until the proof that belongs to the test refutes one too: so that there is a
//! wrong change of every function that a named proof finds. Then what survived the tests, of the harnesses of its subject.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::super::PARTS;
use super::super::checker::{self, How, Which};
use super::instrumented::{Listed, folder, list};
use super::{LIKELY, Outcomes, Shard};
use crate::{changes, inspect, shell};

/// The committed list of what is proved.
const LOCK: &str = "proofs/harnesses.lock";
/// How many changes of a function are asked before the next function's turn.
const TRIES: usize = 4;
/// A tick beside its specification, by samples; and the proofs of the same.
const REFINEMENTS: [(&str, &[&str]); 6] = [
    ("every_tick_of_tdpa_is_its_specification", &["p11_tdpa"]),
    ("every_tick_of_fba_is_its_specification", &["p11_fba"]),
    (
        "every_tick_of_the_spring_is_its_specification",
        &["p11_spring"],
    ),
    ("every_tick_of_sfa_is_its_specification", &["p11_sfa"]),
    (
        "every_tick_of_the_enhanced_law_is_its_specification",
        &[
            "p11_enhanced",
            "p11_hand_over",
            "p11_move",
            "p11_offset",
            "p11_mass_forces",
        ],
    ),
    (
        "every_tick_of_the_guard_is_its_specification",
        &["p11_guard"],
    ),
];

/// What asks.
struct Asking {
    /// Harnesses of the lock.
    names: BTreeSet<String>,
    folder: PathBuf,
}

/// The command.
pub fn asked(shard: Shard) -> Result<(), String> {
    let folder = folder().join("by-proofs");
    let list = list(&folder)?;
    let mut outcomes = Outcomes::open()?;
    let lock = std::fs::read_to_string(shell::root().join(LOCK))
        .map_err(|why| format!("{LOCK}: {why}"))?;
    let names = lock
        .lines()
        .filter_map(|line| line.split(' ').next())
        .map(str::to_owned)
        .collect();
    let asking = Asking { names, folder };
    let mut functions = BTreeMap::<String, Vec<&Listed>>::new();
    for one in &list {
        functions.entry(one.function()).or_default().push(one);
    }
    for (number, changes) in functions.values().enumerate() {
        if shard.has(number + 1) {
            a_proof_of(changes, &asking, &mut outcomes)?;
        }
    }
    for one in list.iter().filter(|one| shard.has(one.number)) {
        if outcomes.of(one) == Some("survived") {
            let begun = Instant::now();
            let likely = LIKELY.iter().find(|(file, _)| one.row.contains(file));
            let parts = likely.map_or(&[][..], |(_, parts)| parts);
            let refuted = asking.refuting(one, &asking.containing(parts))?;
            let outcome = refuted.map_or_else(
                || "survived: the checker too".into(),
                |name| format!("refuted: {name}"),
            );
            outcomes.keep(one, outcome, begun.elapsed().as_secs_f64())?;
        }
    }
    Ok(())
}

/// Of a function: changes that a test refuted, until a proof does.
fn a_proof_of(changes: &[&Listed], asking: &Asking, outcomes: &mut Outcomes) -> Result<(), String> {
    let by = |one: &Listed| Some(outcomes.of(one)?.strip_prefix("refuted: ")?.to_owned());
    let mut candidates: Vec<(&Listed, Vec<String>)> = Vec::new();
    for one in changes {
        match by(one) {
            Some(name) if name.contains("::proof") => return Ok(()),
            Some(name) => candidates.push((*one, asking.belonging(&name))),
            None => {}
        }
    }
    candidates.retain(|(_, harnesses)| !harnesses.is_empty());
    // The fewer harnesses there are to ask, the better is known which.
    candidates.sort_by_key(|(_, harnesses)| harnesses.len());
    for (one, harnesses) in candidates.into_iter().take(TRIES) {
        let begun = Instant::now();
        let refuted = asking.refuting(one, &harnesses)?;
        let seconds = begun.elapsed().as_secs_f64();
        match refuted {
            Some(name) => return outcomes.keep(one, format!("refuted: {name}"), seconds),
            None => println!(
                "{:>5} {seconds:>5.1} s  not refuted by {harnesses:?}  {}",
                one.number,
                one.row.replace('\t', " ")
            ),
        }
    }
    Ok(())
}

impl Asking {
    /// The proofs of what a test samples.
    fn belonging(&self, test: &str) -> Vec<String> {
        if let Some(property) = test.strip_suffix("::sampled") {
            let name = format!("{property}::proof");
            return self.names.get(&name).cloned().into_iter().collect();
        }
        let parts = REFINEMENTS.iter().find(|(name, _)| *name == test);
        self.containing(parts.map_or(&[][..], |(_, parts)| parts))
    }

    fn containing(&self, parts: &[&str]) -> Vec<String> {
        let has = |name: &&String| parts.iter().any(|part| name.contains(part));
        self.names.iter().filter(has).cloned().collect()
    }

    /// The first of these harnesses an assertion of which fails with the change.
    fn refuting(&self, one: &Listed, harnesses: &[String]) -> Result<Option<String>, String> {
        if harnesses.is_empty() {
            return Ok(None);
        }
        let work = alone(&self.folder, one)?;
        for harness in harnesses {
            let which = Which::Named(harness);
            let Ok(left) = checker::run(&work, &self.folder.join("kani"), which, How::QUIET) else {
                continue;
            };
            let (lines, _) = inspect::ask(["refuting".as_ref(), left.report.as_os_str()]);
            if lines.contains(harness) {
                return Ok(Some(harness.clone()));
            }
        }
        Ok(None)
    }
}

/// The sources with one change alone in them.
fn alone(folder: &Path, one: &Listed) -> Result<PathBuf, String> {
    let work = changes::copy(folder, &PARTS, &[])?;
    let words = [
        "operators".to_owned(),
        "alone".into(),
        one.number.to_string(),
        work.display().to_string(),
    ];
    match inspect::ask(words).1 {
        crate::outcome::Outcome::Failed(why) => Err(why),
        _ => Ok(work),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_test_belongs_to_the_proof_of_its_name_or_to_the_refinement() {
        let names = [
            "heart::w8::p5_root::proof",
            "refines::w8::p11_fba::proof",
            "refines::w8::p11_sfa::proof",
        ];
        let asking = Asking {
            names: names.map(str::to_owned).into(),
            folder: PathBuf::new(),
        };
        assert_eq!(asking.belonging("heart::w8::p5_root::sampled"), [names[0]]);
        assert_eq!(
            asking.belonging("every_tick_of_fba_is_its_specification"),
            [names[1]]
        );
        for other in ["heart::w8::p5_unproved::sampled", "a_test_of_its_own"] {
            assert!(asking.belonging(other).is_empty(), "{other}");
        }
    }
}
