//! `--mutants --systematic --every`: the wrong changes by rule, asked of the properties of which all inputs are tried.
//!
//! Those are proofs at 8 bits that rest on no solver (`proofs/examples/every.rs`), and most of what they refute fails in the first second.
//! The same copy is built as for the tests, with all changes in it, and each is asked of the properties of its source.

use std::collections::BTreeMap;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use super::instrumented::{Listed, built, folder};
use super::{Outcomes, Shard};
use crate::shell;

/// Processor time of one property with a change, in seconds: some take half of it where they hold.
const MOST_S: u32 = 120;
/// Which properties are about which functions, by file and name: the first that fits.
const ABOUT: [(&str, &[&str]); 33] = [
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
    ("space/root", &["p4_lengths", "p4_polar", "ball_exit"]),
    // All inputs are those of the number format.
    ("number.rs float::", &[]),
    ("number.rs name::share_of_length", &["per_axis"]),
    ("number.rs name::share", &["plane_exit", "box_exit"]),
    ("number.rs name::shortened", &["friction", "p4_within"]),
    ("number.rs name::three_quarters", &["friction"]),
    ("number.rs name::root_of_squares", &["ball_exit"]),
    ("number.rs name::longer", &["vector_guard", "p4_longer"]),
    ("number.rs name::polar", &["p4_unit", "p4_polar"]),
    ("number.rs name::times", &["magnitude", "plane"]),
    ("number.rs name::", &["vectors", "p4_unit", "restricted"]),
    ("space/number", &["restricted", "vectors"]),
    (
        "vector.rs Vector::",
        &["vector_guard", "vectors", "friction", "p4_within"],
    ),
    (
        "space/vector",
        &["vectors", "p4_unit", "p4_polar", "restricted"],
    ),
];

/// The command: one change of each function, then the second of each, and so on.
pub fn asked(shard: Shard) -> Result<(), String> {
    let (work, mut list) = built(&folder())?;
    let program = program(&work)?;
    let names = names(&program)?;
    let mut outcomes = Outcomes::open()?;
    let mut of_function = BTreeMap::<String, usize>::new();
    list.sort_by_cached_key(|one| {
        let before = of_function.entry(one.function()).or_default();
        *before += 1;
        (*before, one.number)
    });
    for one in list.iter().filter(|one| shard.has(one.number)) {
        let about = about(one, &names);
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

/// Whether no more is to be asked: a proof refuted it, or it is none.
fn is_answered(outcome: &str) -> bool {
    super::is_proof(outcome) || outcome == "not Rust" || outcome.starts_with("equivalent")
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

fn names(program: &Path) -> Result<Vec<String>, String> {
    let said = Command::new(program)
        .arg("--list")
        .output()
        .map_err(|why| format!("{}: {why}", program.display()))?;
    let text = String::from_utf8_lossy(&said.stdout).into_owned();
    Ok(text.lines().map(str::to_owned).collect())
}

/// Whether an assertion of a property fails with a change: not a panic of the code itself, nor a cover, nor the time.
fn refutes(program: &Path, number: usize, name: &str) -> Result<bool, String> {
    let mut command = Command::new(program);
    command
        .arg(name)
        .env("TOUCHSTONE_MUTANT", number.to_string())
        .env("RUST_BACKTRACE", "0");
    let mut child = shell::within(&command, MOST_S)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|why| format!("{}: {why}", program.display()))?;
    let errors = child.stderr.take().ok_or("no standard error")?;
    let mut panics = BufReader::new(errors).lines().map_while(Result::ok);
    // The first says it: the one after it is of the program, which misses a worker.
    let refuted = panics.any(|line| line.contains("panicked at proofs/src/"));
    let _ = child.kill();
    child.wait().map_err(|why| why.to_string())?;
    Ok(refuted)
}

#[cfg(test)]
mod tests {
    use super::*;

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
