//! Wrong changes by rule, not chosen: every place of the law's code where one of our operators applies.
//!
//! The list has a row for each, which says what it was, and in the committed table also what refuted it. The launcher builds the
//! code once with all of them in it, asks the tests for each by number, and the checker for what is left.

mod find;
mod instrument;
mod outcome;

use std::path::{Path, PathBuf};

use crate::answer::Answer;
use find::Wrong;

/// Whose functions.
const SOURCES: [&str; 12] = [
    "control/src/law",
    "control/src/filter.rs",
    "control/src/observer.rs",
    "control/src/estimator",
    "control/src/guard",
    "control/src/number",
    "control/src/magnitude.rs",
    "control/src/reciprocal.rs",
    "control/src/coefficients.rs",
    "control/src/controller.rs",
    "control/src/space",
    "protocol/src/machine.rs",
];
/// Not shipped, or tests.
const LEFT_OUT: [&str; 3] = ["float.rs", "reported.rs", "tests.rs"];
/// What a macro makes for floats: the reference, which no firmware has.
const FLOATS: &str = "float::";

/// One of the list.
struct Listed {
    number: u32,
    file: String,
    wrong: Wrong,
    /// The bytes that it changes.
    was: String,
    /// The how manieth of those that are the same in all else.
    ordinal: usize,
}

impl Listed {
    fn is_like(&self, other: &Self) -> bool {
        let (a, b) = (&self.wrong, &other.wrong);
        self.was == other.was
            && (a.operator, &a.function, &a.instead) == (b.operator, &b.function, &b.instead)
    }
    /// What it is called in tables: nothing of where it stands but its function.
    fn row(&self) -> String {
        let one_line = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        let ordinal = self.ordinal.to_string();
        let words = [
            self.file.as_str(),
            &self.wrong.function,
            self.wrong.operator,
            &ordinal,
            &one_line(&self.was),
            &one_line(&self.wrong.instead),
        ];
        words.join("\t")
    }
}

fn files() -> Result<Vec<PathBuf>, String> {
    let mut found = Vec::new();
    let mut folders: Vec<PathBuf> = SOURCES.iter().map(PathBuf::from).collect();
    while let Some(path) = folders.pop() {
        let said = |why: std::io::Error| format!("{}: {why}", path.display());
        if path.is_dir() {
            for entry in std::fs::read_dir(&path).map_err(said)? {
                folders.push(entry.map_err(said)?.path());
            }
        } else if !LEFT_OUT.iter().any(|name| path.ends_with(name)) {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

fn listed() -> Result<Vec<Listed>, String> {
    let mut all: Vec<Listed> = Vec::new();
    for path in files()? {
        let file = path.display().to_string();
        let source = std::fs::read_to_string(&path).map_err(|why| format!("{file}: {why}"))?;
        let found = find::find(&source).map_err(|why| format!("{file}: {why}"))?;
        for wrong in found
            .into_iter()
            .filter(|it| !it.function.starts_with(FLOATS))
        {
            let mut one = Listed {
                number: all.len() as u32 + 1,
                file: file.clone(),
                was: source[wrong.at.clone()].into(),
                wrong,
                ordinal: 1,
            };
            let same = all.iter().rev().take_while(|other| other.file == file);
            one.ordinal += same.filter(|other| other.is_like(&one)).count();
            all.push(one);
        }
    }
    Ok(all)
}

/// Writes the instrumented sources into a copy of the workspace, without the numbers in a file, and prints the list: number, whether it
/// can be chosen at run time, and its row.
pub fn instrument(work: &Path, without: &Path) -> Result<Answer, String> {
    let skipped = std::fs::read_to_string(without).unwrap_or_default();
    let skipped: Vec<u32> = skipped
        .lines()
        .filter_map(|line| line.parse().ok())
        .collect();
    let all = listed()?;
    let usable = |one: &&Listed| !one.wrong.is_const && !skipped.contains(&one.number);
    for path in files()? {
        let file = path.display().to_string();
        let said = |why: std::io::Error| format!("{file}: {why}");
        let source = std::fs::read_to_string(&path).map_err(said)?;
        let here: Vec<(u32, &Wrong)> = all
            .iter()
            .filter(|one| one.file == file)
            .filter(usable)
            .map(|one| (one.number, &one.wrong))
            .collect();
        let text = instrument::instrumented(&source, &file, &here);
        std::fs::write(work.join(&path), text).map_err(said)?;
    }
    let lib = "control/src/lib.rs";
    let said = |why: std::io::Error| format!("{lib}: {why}");
    let source = std::fs::read_to_string(lib).map_err(said)?;
    std::fs::write(work.join(lib), source + instrument::ANSWERS).map_err(said)?;
    for one in &all {
        let can = if usable(&one) { "on" } else { "apart" };
        println!("{}\t{can}\t{}", one.number, one.row());
    }
    Ok(Answer::Right(format!("{} wrong changes", all.len())))
}

/// The numbers that the compiler refuses, from its messages.
pub fn refused(work: &Path, messages: &Path) -> Result<Answer, String> {
    let text = std::fs::read_to_string(messages).map_err(|why| why.to_string())?;
    let mut numbers = std::collections::BTreeSet::new();
    let mut others = Vec::new();
    for line in text.lines() {
        let Ok(message) = serde_json::from_str::<serde_json::Value>(line) else {
            continue;
        };
        let message = &message["message"];
        if message["level"] != "error" {
            continue;
        }
        let spans = message["spans"].as_array().cloned().unwrap_or_default();
        let place = |span: &serde_json::Value| {
            let file = span["file_name"].as_str()?;
            let source = std::fs::read_to_string(work.join(file)).ok()?;
            let byte = usize::try_from(span["byte_start"].as_u64()?).ok()?;
            instrument::number_at(&source, byte)
        };
        let primary = spans.iter().filter(|span| span["is_primary"] == true);
        let found: Vec<u32> = primary.filter_map(place).collect();
        if found.is_empty() && !spans.is_empty() {
            others.push(message["message"].to_string());
        }
        numbers.extend(found);
    }
    for number in &numbers {
        println!("{number}");
    }
    Ok(match (numbers.is_empty(), others.first()) {
        (true, Some(why)) => Answer::Wrong(format!("an error that belongs to no change: {why}")),
        (true, None) => Answer::Right("no error".into()),
        (false, _) => Answer::Right(format!("{} refused", numbers.len())),
    })
}

pub use outcome::table;

/// The source with one change alone in it, for whoever builds it by itself.
pub fn alone(number: &str, work: &Path) -> Result<Answer, String> {
    let all = listed()?;
    let one = all
        .iter()
        .find(|one| one.number.to_string() == number)
        .ok_or_else(|| format!("no change has the number {number}"))?;
    let said = |why: std::io::Error| format!("{}: {why}", one.file);
    let source = std::fs::read_to_string(&one.file).map_err(said)?;
    let at = one.wrong.at.clone();
    let text = format!(
        "{}{}{}",
        &source[..at.start],
        one.wrong.instead,
        &source[at.end..]
    );
    std::fs::write(work.join(&one.file), text).map_err(said)?;
    Ok(Answer::Right(one.file.clone()))
}
