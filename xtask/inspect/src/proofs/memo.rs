//! What was proved before, so that a whole run can be broken off and taken up again: a row a harness, with the numbers of the code and
//! of the statement that it was proved for. A row of another code or statement counts as nothing.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::Value;

use super::lock::{Statements, add};
use super::report::{Answer, Verdict};
use super::usage::Usage;

/// What the harnesses are about.
const CODE: [&str; 3] = ["control/src", "protocol/src", "drive/src"];
/// What they are built with: the version of the fixed-point numbers.
const BUILT_WITH: &str = "name = \"fixed\"";

/// The number of the code.
pub fn code() -> Result<u64, String> {
    let mut files = Vec::new();
    let mut left: Vec<_> = CODE.iter().map(|path| Path::new(path).to_owned()).collect();
    while let Some(path) = left.pop() {
        let said = |why: std::io::Error| format!("{}: {why}", path.display());
        if path.is_dir() {
            for entry in std::fs::read_dir(&path).map_err(said)? {
                left.push(entry.map_err(said)?.path());
            }
        } else {
            files.push((path.clone(), std::fs::read_to_string(&path).map_err(said)?));
        }
    }
    files.sort();
    let number = files.iter().fold(0, |hash, (path, text)| {
        add(add(hash, &path.to_string_lossy()), text)
    });
    let lock = std::fs::read_to_string("Cargo.lock").map_err(|why| format!("Cargo.lock: {why}"))?;
    let package = lock.split("[[package]]").find(|it| it.contains(BUILT_WITH));
    Ok(add(number, package.unwrap_or_default()))
}

/// Adds what was proved within its limits.
pub fn keep(
    memo: &Path,
    found: &BTreeMap<String, Verdict>,
    statements: &Statements,
    fine: impl Fn(&str, &Verdict) -> bool,
) -> Result<(), String> {
    let code = code()?;
    let mut text = std::fs::read_to_string(memo).unwrap_or_default();
    for (name, verdict) in found.iter().filter(|(name, verdict)| fine(name, verdict)) {
        let usage = verdict.usage.unwrap_or_default();
        let row = [
            format!("{code:016x}"),
            statements.line(name),
            verdict.solver.clone(),
            verdict.seconds.to_string(),
            usage.memory_kib.to_string(),
            usage.processor_s.to_string(),
            verdict.covers.0.to_string(),
        ];
        text += &row.join("\t");
        text += "\n";
    }
    std::fs::write(memo, text).map_err(|why| format!("{}: {why}", memo.display()))
}

/// What was proved of this code, as it is stated now.
pub fn kept(memo: &Path, statements: &Statements) -> Result<BTreeMap<String, Verdict>, String> {
    let code = format!("{:016x}", code()?);
    let text = std::fs::read_to_string(memo).unwrap_or_default();
    let row = |line: &str| {
        let words: Vec<&str> = line.split('\t').collect();
        let [of, stated, solver, seconds, memory, processor, covers] = words.as_slice() else {
            return None;
        };
        let name = stated.split(' ').next()?.to_owned();
        let covers = covers.parse().ok()?;
        let verdict = Verdict {
            answer: Answer::Proved,
            own_failed: false,
            covers: (covers, covers),
            seconds: seconds.parse().ok()?,
            solver: (*solver).to_owned(),
            program: String::new(),
            usage: Some(Usage {
                memory_kib: memory.parse().ok()?,
                processor_s: processor.parse().ok()?,
            }),
        };
        (*of == code && statements.agree(stated)).then_some((name, verdict))
    };
    Ok(text.lines().filter_map(row).collect())
}

/// The names of all harnesses, from the checker's own list.
pub fn listed(text: &str) -> Result<Vec<String>, String> {
    let list: Value =
        serde_json::from_str(text).map_err(|why| format!("the checker's list: {why}"))?;
    let files = list["standard-harnesses"]
        .as_object()
        .ok_or("the checker's list has no harnesses")?;
    let mut names: Vec<String> = files
        .values()
        .filter_map(Value::as_array)
        .flatten()
        .filter_map(|name| name.as_str().map(str::to_owned))
        .collect();
    names.sort();
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_of_the_checker_is_read() {
        let text = r#"{"standard-harnesses": {"b.rs": ["b::p::proof"], "a.rs": ["a::q::proof", "a::p::proof"]}}"#;
        assert_eq!(
            listed(text),
            Ok(vec![
                "a::p::proof".into(),
                "a::q::proof".into(),
                "b::p::proof".into()
            ])
        );
        assert!(listed("{}").is_err());
    }

    #[test]
    fn what_was_proved_counts_for_the_same_code_and_statement_only() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        std::env::set_current_dir(root).expect("the workspace");
        let memo = std::env::temp_dir().join(format!("touchstone-memo-{}", std::process::id()));
        let _ = std::fs::remove_file(&memo);
        let verdict = Verdict {
            answer: Answer::Proved,
            own_failed: false,
            covers: (2, 2),
            seconds: 1.5,
            solver: "kissat".into(),
            program: String::new(),
            usage: None,
        };
        let found = BTreeMap::from([("tdpa::w8::p7_leaves::proof".to_owned(), verdict)]);
        let statements = Statements::read().expect("the proofs");
        keep(&memo, &found, &statements, |_, _| true).expect("written");
        let again = kept(&memo, &statements).expect("read");
        assert_eq!(
            again.keys().collect::<Vec<_>>(),
            found.keys().collect::<Vec<_>>()
        );
        // Of other statements, and of another code.
        assert!(
            kept(&memo, &Statements::of_nothing())
                .expect("read")
                .is_empty()
        );
        let text = std::fs::read_to_string(&memo).expect("there");
        std::fs::write(&memo, format!("0{}", &text[1..])).expect("written");
        let changed = kept(&memo, &statements).expect("read");
        assert!(changed.is_empty() || text.starts_with('0'));
        let _ = std::fs::remove_file(&memo);
    }
}
