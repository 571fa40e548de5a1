//! Writes the table with the results of a run of all proofs.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use super::properties::{self, Property};
use super::report::Verdict;
use super::usage::Usage;

/// File name of the table of results, which is in the folder of the model checker's report.
pub const NAME: &str = "table.md";

/// Writes the table with the results of all proofs to the file `path`. Errors: a harness (proof) has no property in the sources.
pub fn write(path: &Path, found: &BTreeMap<String, Verdict>, about: &str) -> Result<(), String> {
    let properties = properties::properties(Path::new("proofs/src"));
    let table = table(found, &properties, about)?;
    std::fs::write(path, table).map_err(|why| format!("{}: {why}", path.display()))
}

/// Table with one row per property (statement to prove). A property that is proved at several widths has one line per width in the
/// last columns.
fn table(
    found: &BTreeMap<String, Verdict>,
    properties: &[Property],
    about: &str,
) -> Result<String, String> {
    let mut text = format!("\n{about}\n");
    let mut file = "";
    let mut shown = 0;
    for property in properties {
        let runs: Vec<_> = found
            .iter()
            .filter(|(name, _)| is_of(name, property))
            .collect();
        if runs.is_empty() {
            continue;
        }
        shown += runs.len();
        if property.file != file {
            file = &property.file;
            let _ = writeln!(text, "\n**`{file}.rs`**\n\n{HEAD}");
        }
        let column = |of: &dyn Fn(&str, &Verdict) -> String| {
            let cells: Vec<_> = runs
                .iter()
                .map(|(name, verdict)| of(name, verdict))
                .collect();
            cells.join("<br>")
        };
        let usage = |of: &dyn Fn(Usage) -> String| {
            column(&|_, verdict| verdict.usage.map_or("-".into(), of))
        };
        let assumptions = if property.assumptions.is_empty() {
            "none".into()
        } else {
            property.assumptions.join("; ")
        };
        let cells = [
            property.design(),
            property.meaning.clone(),
            code(&property.equation),
            property.over.clone(),
            assumptions,
            column(&|name, _| code(name.trim_end_matches("::proof"))),
            column(&|name, _| width(name)),
            column(&|_, verdict| verdict.solver.clone()),
            column(&|_, verdict| format!("{:.1}", verdict.seconds)),
            usage(&|usage| format!("{:.1}", usage.processor_s)),
            usage(&|usage| format!("{:.0}", usage.memory_kib as f64 * 1024.0 / 1e6)),
            column(&|_, verdict| format!("{}/{}", verdict.covers.0, verdict.covers.1)),
            column(&|_, verdict| verdict.words()),
        ];
        let cells = cells.map(|cell| cell.replace('|', "\\|"));
        let _ = writeln!(text, "| {} |", cells.join(" | "));
    }
    // Harnesses of equally named properties are counted with each of them, so `shown` may exceed the number of harnesses.
    if shown >= found.len() {
        Ok(text)
    } else {
        Err(format!(
            "{} harnesses have no property in the sources",
            found.len() - shown
        ))
    }
}

const HEAD: &str = "\
| | meaning | equation | covers every | assumes (enforced by) | harness | width | solver | s | CPU s | MB | covers | answer |\n\
|---|---|---|---|---|---|---:|---|---:|---:|---:|---|---|";

fn code(text: &str) -> String {
    format!("`{text}`")
}

/// Whether a harness (proof) belongs to a property: `tdpa::w8::p7_leaves::proof` proves the property `p7_leaves` in `tdpa.rs`.
fn is_of(harness: &str, property: &Property) -> bool {
    let parts: Vec<&str> = harness.split("::").collect();
    matches!(parts.as_slice(), [file, .., name, "proof"] if *file == property.file && *name == property.name)
}

/// Width of the numbers in bits for which a harness (proof) holds, from the digits in the harness's path or at the end of its name;
/// `-` if there are none.
fn width(harness: &str) -> String {
    let parts: Vec<&str> = harness.split("::").collect();
    let digits = |part: &&str| {
        let end = part.trim_start_matches(|c: char| !c.is_ascii_digit());
        (!end.is_empty() && end.chars().all(|c| c.is_ascii_digit())).then(|| end.to_string())
    };
    let module = parts.iter().skip(1).rev().skip(2).find_map(digits);
    let name = parts.iter().rev().nth(1).and_then(|name| {
        let at = name.trim_end_matches(|c: char| c.is_ascii_digit()).len();
        (at < name.len()).then(|| name[at..].to_string())
    });
    module.or(name).unwrap_or_else(|| "-".into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::proofs::report::Answer;

    #[test]
    fn the_width_is_in_the_path() {
        assert_eq!(width("tdpa::w8::p7_leaves::proof"), "8");
        assert_eq!(width("facts::fixed32::p3_fact_root::proof"), "32");
        assert_eq!(width("device::p9_unwrap16::proof"), "16");
        assert_eq!(width("device::p10_outputs::proof"), "-");
    }

    #[test]
    fn a_row_has_every_column_and_nothing_is_left_out() {
        let property = Property {
            file: "tdpa".into(),
            name: "p7_leaves".into(),
            meaning: "P7: leaves.".into(),
            equation: "|f| = 0".into(),
            over: "position".into(),
            assumptions: vec![],
        };
        let verdict = Verdict {
            own_failed: false,
            answer: Answer::Proved,
            covers: (2, 2),
            seconds: 1.25,
            solver: "kissat".into(),
            program: String::new(),
            usage: Some(Usage {
                memory_kib: 100_000,
                processor_s: 1.1,
            }),
        };
        let mut found =
            BTreeMap::from([("tdpa::w8::p7_leaves::proof".to_string(), verdict.clone())]);
        let text = table(&found, std::slice::from_ref(&property), "about").expect("a table");
        assert!(text.contains(
            "| P7 | P7: leaves. | `\\|f\\| = 0` | position | none | `tdpa::w8::p7_leaves` | 8 | kissat | 1.2 | 1.1 | 102 | 2/2 | proved |"
        ), "{text}");
        found.insert("tdpa::w8::p8_other::proof".into(), verdict);
        assert!(table(&found, &[property], "about").is_err());
    }
}
