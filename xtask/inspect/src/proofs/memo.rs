//! Stores results of successful proofs in a file, so that an interrupted run can continue. Each line has a harness (proof) with its
//! hashes of statement and code. A result for another statement or other code does not count.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::Value;

use super::lock::{Standing, Statements, name};
use super::report::{Answer, Verdict};
use super::usage::Usage;

/// Appends to the file the harnesses (proofs) that `fine` accepts: those that were proved within their limits of time and memory.
pub fn keep(
    memo: &Path,
    found: &BTreeMap<String, Verdict>,
    statements: &Statements,
    fine: impl Fn(&str, &Verdict) -> bool,
) -> Result<(), String> {
    let mut text = std::fs::read_to_string(memo).unwrap_or_default();
    for (name, verdict) in found.iter().filter(|(name, verdict)| fine(name, verdict)) {
        let usage = verdict.usage.unwrap_or_default();
        let row = [
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

/// Reads from the file `memo` the results that are valid for the present code and statements.
pub fn kept(memo: &Path, statements: &Statements) -> BTreeMap<String, Verdict> {
    let text = std::fs::read_to_string(memo).unwrap_or_default();
    let row = |line: &str| {
        let words: Vec<&str> = line.split('\t').collect();
        let [stated, solver, seconds, memory, processor, covers] = words.as_slice() else {
            return None;
        };
        let name = name(stated).to_owned();
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
        (statements.standing(stated) == Standing::Proved).then_some((name, verdict))
    };
    text.lines().filter_map(row).collect()
}

/// Names of all harnesses (proofs) in the model checker's list. Errors: the text is not such a list.
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
        let again = kept(&memo, &statements);
        assert_eq!(
            again.keys().collect::<Vec<_>>(),
            found.keys().collect::<Vec<_>>()
        );
        // Results for other statements and for other code do not count.
        assert!(kept(&memo, &Statements::of_nothing()).is_empty());
        let text = std::fs::read_to_string(&memo).expect("there");
        let line = statements.line("tdpa::w8::p7_leaves::proof");
        let (statement, code) = line.rsplit_once(' ').expect("two numbers");
        let other = text.replace(
            &line,
            &format!("{statement} {}", code.replace(|_| true, "0")),
        );
        assert_ne!(other, text);
        std::fs::write(&memo, other).expect("written");
        assert!(kept(&memo, &statements).is_empty());
        let _ = std::fs::remove_file(&memo);
    }
}
