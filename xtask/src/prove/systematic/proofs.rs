//! `--mutants --systematic --proofs`: the wrong changes by rule, asked of the checker.
//!
//! First, of each function, changes that a test refuted, until a proof refutes one too, the proof that belongs to the test first and
//! then those that reach the function, as the names in the checker's programs say: so that there is a wrong change of every function
//! that a named proof finds, or it is known that no proof reaches it. Then what survived the tests, of the harnesses that reach it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::Instant;

use super::super::PARTS;
use super::super::checker::{self, How, Which};
use super::instrumented::{Listed, folder, list};
use super::{LIKELY, Outcomes, Shard};
use crate::outcome::Outcome;
use crate::{changes, inspect, shell};

/// The committed list of what is proved.
const LOCK: &str = "proofs/harnesses.lock";
/// How many changes of a function are asked before the next function's turn.
const TRIES: usize = 3;
/// How many harnesses are asked of a change: the smaller ones first.
const ASKED: usize = 3;
/// Processor time of a process, in seconds: most harnesses that refute a change do so in a few.
const PROCESS_S: u32 = 100;
/// Parts of the names of what builds a law of its settings.
const BUILDING: [&str; 2] = ["_accepted", "controller::"];
/// Part of the names of what proves a tick to be its specification.
const OF_A_TICK: &str = "p11_";
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
    /// Of each harness, the smaller programs first: the functions in it.
    reached: Vec<(String, Vec<String>)>,
    folder: PathBuf,
    /// No others than those with this in their names: all, if it is empty.
    part: String,
}

/// The command.
pub fn asked(shard: Shard, part: &str) -> Result<(), String> {
    let folder = folder().join(format!("by-proofs-{}", shard.index));
    let list = list(&folder)?;
    let mut outcomes = Outcomes::open()?;
    let lock = std::fs::read_to_string(shell::root().join(LOCK))
        .map_err(|why| format!("{LOCK}: {why}"))?;
    let names = lock
        .lines()
        .filter_map(|line| line.split(' ').next())
        .map(str::to_owned)
        .collect();
    let asking = Asking {
        names,
        reached: reached()?,
        folder,
        part: part.to_owned(),
    };
    let mut functions = BTreeMap::<String, Vec<&Listed>>::new();
    for one in &list {
        functions.entry(one.function()).or_default().push(one);
    }
    let mut waiting: Vec<Candidates> = functions
        .values()
        .enumerate()
        .filter(|(number, _)| shard.has(number + 1))
        .filter_map(|(_, changes)| candidates(changes, &asking, &outcomes))
        .collect();
    // Few harnesses are asked soon, and are the ones that are about the function.
    waiting.sort_by_key(|of| {
        of.first()
            .map(|(rank, _, harnesses)| (harnesses.len(), *rank))
    });
    // One change of each function, then the second of those that are left.
    for round in 0..TRIES {
        let mut left = Vec::new();
        for of in waiting {
            if let Some((_, one, harnesses)) = of.get(round)
                && !is_refuted(one, harnesses, &asking, &mut outcomes)?
            {
                left.push(of);
            }
        }
        waiting = left;
    }
    for one in list.iter().filter(|one| shard.has(one.number)) {
        if outcomes.of(one) == Some("survived") {
            // Not refuted says little: a proof may have had no answer in its time. It stays a survivor of the tests.
            let harnesses = asking.reaching(one);
            if !harnesses.is_empty() {
                is_refuted(one, &harnesses, &asking, &mut outcomes)?;
            }
        }
    }
    Ok(())
}

/// Which functions the harnesses reach: their programs are made for it.
fn reached() -> Result<Vec<(String, Vec<String>)>, String> {
    let programs = checker::programs(&shell::root(), &folder().join("programs"))?;
    let (lines, outcome) = inspect::ask(["reached".as_ref(), programs.as_os_str()]);
    if !matches!(outcome, Outcome::Ok(_)) {
        return Err(outcome.reason().into());
    }
    let mut found: Vec<(u64, String, Vec<String>)> = lines
        .iter()
        .filter_map(|line| {
            let mut words = line.split('\t');
            let (name, size, functions) = (words.next()?, words.next()?, words.next()?);
            let functions = functions.split(';').map(str::to_owned).collect();
            Some((size.parse().ok()?, name.to_owned(), functions))
        })
        .collect();
    found.sort();
    Ok(found
        .into_iter()
        .map(|(_, name, functions)| (name, functions))
        .collect())
}

/// How well it is known which proof refutes a change, the change, and the harnesses to ask.
type Candidates<'a> = Vec<(usize, &'a Listed, Vec<String>)>;

/// Of a function that no proof has refuted a change of yet: changes that a test refuted, then the others.
fn candidates<'a>(
    changes: &[&'a Listed],
    asking: &Asking,
    outcomes: &Outcomes,
) -> Option<Candidates<'a>> {
    let mut found = Candidates::new();
    for one in changes {
        let reaching = asking.reaching(one);
        let (rank, harnesses) = match outcomes.of(one) {
            Some(by) if super::is_proof(by) => return None,
            Some("not Rust") => continue,
            Some(by) if by.starts_with("refuted: ") => {
                let belonging = asking.belonging(by.trim_start_matches("refuted: "));
                let (first, others): (Vec<_>, Vec<_>) = reaching
                    .into_iter()
                    .partition(|name| belonging.contains(name));
                let rank = usize::from(first.is_empty());
                (rank, first.into_iter().chain(others).collect())
            }
            Some(_) => (3, reaching),
            None => (2, reaching),
        };
        found.push((rank, *one, harnesses));
    }
    found.retain(|(_, _, harnesses)| !harnesses.is_empty());
    if let (true, Some(one)) = (found.is_empty(), changes.first()) {
        println!(
            "{:>5} no proof reaches, but those that build a law of settings  {}",
            one.number,
            one.function()
        );
    }
    // The fewer harnesses there are to ask, the better is known which.
    found.sort_by_key(|(rank, _, harnesses)| (*rank, harnesses.len()));
    Some(found)
}

/// Whether a proof refutes it: then it is written down.
fn is_refuted(
    one: &Listed,
    harnesses: &[String],
    asking: &Asking,
    outcomes: &mut Outcomes,
) -> Result<bool, String> {
    let begun = Instant::now();
    let refuted = asking.refuting(one, harnesses)?;
    let seconds = begun.elapsed().as_secs_f64();
    if let Some(name) = refuted {
        outcomes.keep(one, format!("refuted: {name}"), seconds)?;
        return Ok(true);
    }
    // Where there was no list of refused changes for it, as in a `const` function: what does not compile is asked of nobody again.
    if outcomes.of(one).is_none() && !asking.is_rust(one)? {
        outcomes.keep(one, "not Rust".into(), seconds)?;
        return Ok(false);
    }
    println!(
        "{:>5} {seconds:>5.1} s  not refuted, or no answer, by {} proofs, {} first  {}",
        one.number,
        harnesses.len().min(ASKED),
        harnesses.first().map_or("", String::as_str),
        one.row.replace('\t', " ")
    );
    Ok(false)
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

    /// The harnesses that reach the function of a change: those that say all of a tick first, then those of its subject, the smaller
    /// ones first.
    fn reaching(&self, one: &Listed) -> Vec<String> {
        let mut row = one.row.split('\t');
        let module = module(row.next().unwrap_or_default());
        let function = row.next().unwrap_or_default();
        let (subject, others): (Vec<String>, Vec<String>) = self
            .reached
            .iter()
            .filter(|(name, functions)| {
                self.names.contains(name)
                    && name.contains(&self.part)
                    && functions.iter().any(|of| is_of(of, function, &module))
            })
            .map(|(name, _)| name.clone())
            .partition(|name| {
                let of_file = LIKELY.iter().find(|(file, _)| one.row.contains(file));
                of_file.is_some_and(|(_, parts)| parts.iter().any(|part| name.contains(part)))
            });
        // What builds a law of settings reaches much that it says nothing of, and takes long.
        let builds = |name: &String| BUILDING.iter().any(|part| name.contains(part));
        let mut all: Vec<String> = subject.into_iter().chain(others).collect();
        let is_asked_for = !self.part.is_empty() || one.row.contains("controller.rs");
        all.retain(|name| is_asked_for || !builds(name));
        all.sort_by_key(|name| !name.contains(OF_A_TICK));
        all
    }

    /// Whether the change compiles.
    fn is_rust(&self, one: &Listed) -> Result<bool, String> {
        let work = alone(&self.folder, one)?;
        let mut check = shell::cargo_locked("check");
        check
            .current_dir(&work)
            .args(["--quiet", "--package", "touchstone-proofs", "--target-dir"])
            .arg(self.folder.join("check"))
            .stderr(std::process::Stdio::null());
        let status = check.status().map_err(|why| format!("cargo: {why}"))?;
        Ok(status.success())
    }

    /// The first of these harnesses an assertion of which fails with the change.
    fn refuting(&self, one: &Listed, harnesses: &[String]) -> Result<Option<String>, String> {
        if harnesses.is_empty() {
            return Ok(None);
        }
        let work = alone(&self.folder, one)?;
        let some = &harnesses[..harnesses.len().min(ASKED)];
        let how = How {
            process_s: PROCESS_S,
            ..How::QUIET
        };
        // What does not compile, or does not end, refutes nothing.
        let Ok(left) = checker::run(&work, &self.folder.join("kani"), Which::These(some), how)
        else {
            return Ok(None);
        };
        let (lines, _) = inspect::ask(["refuting".as_ref(), left.report.as_os_str()]);
        Ok(some.iter().find(|name| lines.contains(name)).cloned())
    }
}

/// `guard::settings` of `control/src/guard/settings.rs`.
fn module(file: &str) -> String {
    let path = file.split_once("src/").map_or(file, |(_, path)| path);
    let path = path.trim_end_matches(".rs").trim_end_matches("/mod");
    path.replace('/', "::")
}

/// Whether a name in a program, `filter::VirtualMass::drive`, is that of a function of the list, `VirtualMass::drive`, or of one that a
/// macro makes for several types, `name::work`. Where a type's functions are in another module than the type, the program has the module
/// in its place.
fn is_of(in_program: &str, function: &str, module: &str) -> bool {
    let mut names = function.split("::");
    let of_type = names.next().filter(|_| function.contains("::"));
    let method = function.rsplit("::").next().unwrap_or_default();
    let of_macro = |name: &str| name.len() == 1 || name.starts_with(|c: char| c.is_lowercase());
    let Some((path, last)) = in_program.rsplit_once("::") else {
        return false;
    };
    let named = match method.strip_prefix('_') {
        // The name is the macro's, and each type has its own.
        Some(stem) => last.contains(stem),
        None => last == method,
    };
    let is_of_type = |name: &str| of_macro(name) || path.split("::").any(|of| of == name);
    named && (path == module || of_type.is_none_or(is_of_type))
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
            reached: Vec::new(),
            folder: PathBuf::new(),
            part: String::new(),
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

    #[test]
    fn a_function_is_known_in_the_checkers_program() {
        for (in_program, function, is) in [
            ("filter::VirtualMass::drive", "VirtualMass::drive", true),
            ("Fixed8::work", "name::work", true),
            ("law::Tdpa::tick", "Fba::tick", false),
            ("magnitude::divide_16", "_divide", true),
            ("space::Cuboid::exit", "Cuboid::Surface::exit", true),
            ("guard::settings::validate", "GuardSettings::validate", true),
            (
                "estimator::settings::validate",
                "GuardSettings::validate",
                false,
            ),
        ] {
            let module = module("control/src/guard/settings.rs");
            assert_eq!(is_of(in_program, function, &module), is, "{function}");
        }
        assert_eq!(module("control/src/guard/mod.rs"), "guard");
    }
}
