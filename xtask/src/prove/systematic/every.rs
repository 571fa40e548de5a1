//! `--mutants --systematic --every`: the wrong changes by rule, asked of the properties of which all inputs are tried.
//!
//! Those are proofs at 8 bits that rest on no solver (`proofs/examples/every.rs`), and most of what they refute fails in the first second.
//! The same copy is built as for the tests, with all changes in it, and each is asked of the properties of its source.

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use super::instrumented::{Listed, built, folder};
use super::{Outcomes, Shard, in_turns};
use crate::shell;

/// Processor time of one property with a change, in seconds: some take half of it where they hold.
const MOST_S: u32 = 120;
/// Which properties are about which functions, by file and name: the first that fits.
const ABOUT: [(&str, &[&str]); 33] = [
    ("control/src/reciprocal", &["reciprocal_8"]),
    ("environment/sphere", &["ball", "restricted"]),
    ("environment/cuboid", &["box", "shape"]),
    ("environment/cylinder", &["cylinder", "shape"]),
    ("environment/plate", &["plate", "shape"]),
    ("environment/plane", &["plane_", "shape"]),
    ("environment/facets", &["facets"]),
    ("environment/wedge", &["edge", "corner", "shape"]),
    ("environment/mod.rs slanted", &["plane_exit", "box_exit"]),
    ("environment/mod", &["shape", "box_nearest", "ball"]),
    ("space/friction", &["friction"]),
    ("space/guard", &["vector_guard"]),
    ("space/bounding", &["bounding"]),
    ("per_axis.rs Leaving", &["leaving"]),
    ("space/per_axis", &["per_axis"]),
    ("space/surface_point", &["point"]),
    ("space/touch", &["displacement", "point", "magnitude"]),
    ("space/magnitude", &["magnitude", "wall"]),
    ("space/scalar", &["magnitude", "per_axis"]),
    ("space/wall", &["wall", "magnitude", "per_axis"]),
    ("space/root", &["p4_lengths", "p4_polar", "root_of_halves"]),
    ("number.rs name::share_of_length", &["per_axis"]),
    ("number.rs name::share", &["plane_exit", "box_exit"]),
    ("number.rs name::shortened", &["friction", "hardly"]),
    ("number.rs name::three_quarters", &["friction"]),
    ("number.rs name::root_of_squares", &["ball_exit"]),
    ("number.rs name::longer", &["vector_guard"]),
    ("number.rs name::polar", &["p4_unit", "p4_polar"]),
    ("number.rs name::times", &["magnitude", "plane"]),
    ("number.rs name::", &["vectors", "p4_unit", "restricted"]),
    ("space/number", &["restricted", "vectors"]),
    (
        "vector.rs Vector::",
        &["vector_guard", "vectors", "friction"],
    ),
    (
        "space/vector",
        &[
            "vectors",
            "p4_unit",
            "p4_polar",
            "restricted",
            "box_nearest",
        ],
    ),
];

/// The command.
pub fn asked(shard: Shard) -> Result<(), String> {
    let (work, mut list) = built(&folder())?;
    let program = program(&work)?;
    let names = trusted(&program)?;
    let mut outcomes = Outcomes::open()?;
    in_turns(&mut list);
    for one in list.iter().filter(|one| shard.has(one.number)) {
        let about = about(one, &names);
        let is_answered = |outcome: &str| is_answered(outcome, &names);
        if about.is_empty() || outcomes.of(one).is_some_and(is_answered) {
            continue;
        }
        let begun = Instant::now();
        if !one.is_in {
            outcomes.keep(one, "not Rust".into(), begun.elapsed().as_secs_f64())?;
            continue;
        }
        let mut found = None;
        for name in &about {
            if refutes(&program, one.number, name)? {
                found = Some(*name);
                break;
            }
        }
        let seconds = begun.elapsed().as_secs_f64();
        match found {
            Some(name) => outcomes.keep(one, format!("refuted: {name}::every"), seconds)?,
            None => println!(
                "{:>5} {seconds:>5.1} s  not refuted by {} properties, {} first  {}",
                one.number,
                about.len(),
                about[0],
                one.row.replace('\t', " ")
            ),
        }
    }
    Ok(())
}

/// Whether no more is to be asked: a proof refuted it, and one that is still there, or it is none.
fn is_answered(outcome: &str, names: &[String]) -> bool {
    let by = outcome
        .strip_prefix("refuted: ")
        .and_then(|by| by.strip_suffix("::every"));
    match by {
        Some(name) => names.iter().any(|known| known == name),
        None => {
            super::is_proof(outcome) || outcome == "not Rust" || outcome.starts_with("equivalent")
        }
    }
}

/// The properties of a change's source, in the order in which they are asked.
fn about<'a>(one: &Listed, names: &'a [String]) -> Vec<&'a str> {
    let function = one.function();
    let Some((_, words)) = ABOUT.iter().find(|(of, _)| function.contains(of)) else {
        return Vec::new();
    };
    let mut found = Vec::new();
    for word in *words {
        for name in names {
            if name.contains(word) && !found.contains(&name.as_str()) {
                found.push(name.as_str());
            }
        }
    }
    found
}

/// The program that tries all inputs, with all changes in it.
fn program(work: &Path) -> Result<PathBuf, String> {
    let target = folder().join("target");
    let status = shell::cargo("build")
        .current_dir(work)
        .env("CARGO_TARGET_DIR", &target)
        .args(["-q", "--profile", "every", "-p", "touchstone-proofs"])
        .args(["--example", "every"])
        .status()
        .map_err(|why| format!("cargo: {why}"))?;
    if !status.success() {
        return Err(
            "the copy with the changes in it: proofs/examples/every.rs does not compile".into(),
        );
    }
    Ok(target.join("every/examples/every"))
}

/// The properties that hold in that program where no change is on, within the time: those that do not say nothing of a change.
fn trusted(program: &Path) -> Result<Vec<String>, String> {
    let said = Command::new(program)
        .arg("--list")
        .output()
        .map_err(|why| format!("{}: {why}", program.display()))?;
    let text = String::from_utf8_lossy(&said.stdout).into_owned();
    let used = |name: &&str| {
        ABOUT
            .iter()
            .any(|(_, words)| words.iter().any(|word| name.contains(word)))
    };
    let mut found = Vec::new();
    for name in text.lines().filter(used) {
        let mut command = with_change(program, 0, name);
        let status = command.stderr(Stdio::null()).status();
        if status.is_ok_and(|status| status.success()) {
            found.push(name.to_owned());
        } else {
            eprintln!("left out, as it does not hold in time without a change: {name}");
        }
    }
    for word in ABOUT.iter().flat_map(|(_, words)| *words) {
        if !found.iter().any(|name| name.contains(word)) {
            return Err(format!("no property that holds has a name with `{word}`"));
        }
    }
    Ok(found)
}

/// One property with a change on, within the time.
fn with_change(program: &Path, number: usize, name: &str) -> Command {
    let mut command = Command::new(program);
    command
        .arg(name)
        .env("TOUCHSTONE_MUTANT", number.to_string())
        .env("RUST_BACKTRACE", "0");
    let mut limited = shell::within(&command, MOST_S);
    limited.stdout(Stdio::null());
    limited
}

/// What a property says where it fails: an assertion, or one of these.
const SAID: [&str; 4] = [
    "assertion ",
    "no way out",
    "nothing is held",
    "no overspeed",
];

/// Whether an assertion of a property fails with a change: not a panic of the code itself, nor a cover, nor the time.
fn refutes(program: &Path, number: usize, name: &str) -> Result<bool, String> {
    let mut child = with_change(program, number, name)
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|why| format!("{}: {why}", program.display()))?;
    let errors = child.stderr.take().ok_or("no standard error")?;
    let mut lines = BufReader::new(errors).lines().map_while(Result::ok);
    let mut refuted = false;
    while let Some(line) = lines.next() {
        if is_a_propertys(&line) {
            // The line after the place says what failed.
            let said = lines.next().unwrap_or_default();
            refuted = SAID.iter().any(|word| said.starts_with(word));
            break;
        }
    }
    let _ = child.kill();
    child.wait().map_err(|why| why.to_string())?;
    Ok(refuted)
}

/// Whether a line is the place of a panic in a property, and not in the code, in a number format or in the program that tries all inputs.
fn is_a_propertys(line: &str) -> bool {
    line.contains("panicked at proofs/src/") && !line.contains("/facts.rs:")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_of_the_code_or_of_the_program_refutes_nothing() {
        for (place, is) in [
            (
                "thread '<unnamed>' (7) panicked at proofs/src/objects.rs:9:1:",
                true,
            ),
            (
                "thread '<unnamed>' (7) panicked at control/src/space/number.rs:9:1:",
                false,
            ),
            (
                "thread '<unnamed>' (7) panicked at proofs/src/facts.rs:9:1:",
                false,
            ),
            (
                "thread 'main' (7) panicked at proofs/examples/every.rs:9:1:",
                false,
            ),
        ] {
            assert_eq!(is_a_propertys(place), is, "{place}");
        }
    }

    #[test]
    fn what_a_property_refuted_that_is_gone_is_asked_again() {
        let names = ["planes::p4_edge_exit".to_owned()];
        for (outcome, is) in [
            ("refuted: planes::p4_edge_exit::every", true),
            ("refuted: planes::p4_gone::every", false),
            ("refuted: heart::w8::p1_divide::proof", true),
            ("refuted: planes::p4_edge_exit::sampled", false),
            ("survived", false),
        ] {
            assert_eq!(is_answered(outcome, &names), is, "{outcome}");
        }
    }

    #[test]
    fn a_change_is_asked_of_the_properties_of_its_source() {
        let names = ["planes::p4_edge_exit", "objects::p4_ball_exit"].map(str::to_owned);
        let one = |file: &str| Listed {
            number: 1,
            is_in: true,
            row: format!("control/src/space/{file}.rs\tf\tconstant\t1\t1\t2"),
        };
        assert_eq!(about(&one("environment/wedge"), &names), [&names[0]]);
        assert_eq!(about(&one("environment/sphere"), &names), [&names[1]]);
        assert!(about(&one("friction"), &names).is_empty());
    }
}
