//! Reads from the sources what each property (statement to prove) says: its meaning, its equation, the inputs for which it holds,
//! and its assumptions.
//!
//! The macro `property!` requires meaning, equation and inputs; `assume!` and `such!` require a reason for each assumption. A
//! property without them does not compile, so this module need not check for them. Assumptions are shown as they stand in the
//! property's code.

use std::path::Path;

use super::items::writes_a_property;

/// A property of the code that is proved, as its source describes it. It may be proved for several widths of numbers.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Property {
    /// Name of the file with the property, without ending, such as `tdpa`.
    pub file: String,
    /// Name of the property (statement to prove), such as `p7_leaves`.
    pub name: String,
    /// The comment above the property, one or two sentences such as `P1: ...`.
    pub meaning: String,
    /// The proved equation, over integers or in words.
    pub equation: String,
    /// The configurations, states and inputs for which the equation holds.
    pub over: String,
    /// The assumptions of the proof, each with the check or type that guarantees it.
    pub assumptions: Vec<String>,
}

impl Property {
    /// Label of the group of properties to which this one belongs: `P1` for the name `p1_pays`.
    pub fn design(&self) -> String {
        let numbers = self.name.split('_').next().unwrap_or_default();
        numbers.to_uppercase()
    }
}

/// All properties (statements to prove) in the source files of a folder.
pub fn properties(folder: &Path) -> Vec<Property> {
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|end| end == "rs"))
        .collect();
    files.sort();
    let mut found = Vec::new();
    for path in files {
        let file = path
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        found.extend(read(&file, &text));
    }
    found
}

/// The properties (statements to prove) in the text of one source file; `file` is the file's name.
pub fn read(file: &str, text: &str) -> Vec<Property> {
    let mut found: Vec<Property> = Vec::new();
    // `None` outside any property, `Some(false)` in its head, `Some(true)` in its body.
    let mut body = None;
    let mut depth = String::new();
    let mut open = String::new();
    for line in text.lines() {
        let code = line.trim();
        if code.strip_suffix("! {").is_some_and(writes_a_property) {
            depth = line[..line.len() - line.trim_start().len()].to_string();
            found.push(Property {
                file: file.into(),
                ..Property::default()
            });
            body = Some(false);
            continue;
        }
        // The closing brace of a property has the same indentation as its first line.
        if body.is_some() && line == format!("{depth}}}") {
            body = None;
        }
        let (Some(inside), Some(property)) = (body, found.last_mut()) else {
            continue;
        };
        if !inside {
            if let Some(words) = code.strip_prefix("/// ") {
                property.meaning = format!("{} {words}", property.meaning).trim().into();
            } else if let Some(words) = quoted(code, "equation ") {
                property.equation = words;
            } else if let Some(words) = quoted(code, "over ") {
                property.over = words;
            }
            if let Some((_, name)) = code.split_once("fn ") {
                property.name = name.split('(').next().unwrap_or_default().into();
                body = Some(true);
            }
            continue;
        }
        // An `assume!` or `such!` may span several lines, up to the line that ends in `);`.
        if code.starts_with("assume!(") || code.contains("such!(") || !open.is_empty() {
            let gap = if open.is_empty() || open.ends_with('(') {
                ""
            } else {
                " "
            };
            open = open + gap + code;
            if code.ends_with(");") {
                property.assumptions.extend(assumption(&open));
                open.clear();
            }
        }
    }
    found
}

fn quoted(code: &str, key: &str) -> Option<String> {
    let rest = code.strip_prefix(key)?.strip_prefix('"')?;
    Some(rest.rsplit_once('"')?.0.replace("\\\"", "\""))
}

/// Condition and reason of an assumption: `assume!(s, x > 0, "types");` gives `x > 0 (types)`.
fn assumption(code: &str) -> Option<String> {
    let inner = code.split_once("!(")?.1.strip_suffix(");")?.trim_end();
    let (rest, why) = inner.strip_suffix('"')?.rsplit_once(", \"")?;
    // The condition is all after the first argument of `assume!`, or the body of the closure in `such!`.
    let condition = if code.starts_with("assume!(") {
        rest.split_once(", ")?.1
    } else {
        rest.rsplit_once("| ")?.1
    };
    Some(format!("`{condition}` ({why})"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_property_is_read_with_what_it_assumes() {
        let text = r#"
            property! {
                /// P7: outside the wall
                /// nothing is left.
                equation "f' = 0"
                over "every one"
                by $sums fn p7_leaves(s) {
                    let law = such!(s, Tdpa::<N>::any(s), |law| law.valid(), "validate");
                    assume!(s, e > 0 && f(e, 2) < 1, "the type, whatever it is");
                    assume!(
                        s,
                        on && two,
                        "lines"
                    );
                    assert!(true);
                }
            }
            fn other(s) { assume!(s, x, "not of it"); }
        "#;
        let found = read("tdpa", text);
        let expected = Property {
            file: "tdpa".into(),
            name: "p7_leaves".into(),
            meaning: "P7: outside the wall nothing is left.".into(),
            equation: "f' = 0".into(),
            over: "every one".into(),
            assumptions: vec![
                "`law.valid()` (validate)".into(),
                "`e > 0 && f(e, 2) < 1` (the type, whatever it is)".into(),
                "`on && two` (lines)".into(),
            ],
        };
        assert_eq!(found, [expected]);
    }

    /// Checks that every property in the real sources has a meaning, an equation and inputs, and that the module finds every
    /// assumption.
    #[test]
    fn every_property_says_what_it_is_about() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../proofs/src");
        let found = properties(&folder);
        assert!(found.len() > 50, "{}", found.len());
        for property in &found {
            assert!(property.meaning.starts_with('P'), "{property:?}");
            assert!(
                !property.equation.is_empty() && !property.over.is_empty(),
                "{property:?}"
            );
        }
        let mut uses = 0;
        for entry in std::fs::read_dir(&folder).expect("the proofs") {
            let path = entry.expect("readable").path();
            // The file `source.rs` defines the macros.
            if path.ends_with("source.rs") || path.is_dir() {
                continue;
            }
            let text = std::fs::read_to_string(path).expect("readable");
            uses += text.matches("assume!(").count() + text.matches("such!(").count();
        }
        let read: usize = found
            .iter()
            .map(|property| property.assumptions.len())
            .sum();
        assert_eq!(read, uses);
    }
}
