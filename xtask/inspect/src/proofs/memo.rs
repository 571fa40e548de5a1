//! What was proved before, so that a whole run can be broken off and taken up again: a row a harness, with the numbers of the code and
//! of the statement that it was proved for. A row of another code or statement counts as nothing.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use serde_json::Value;

use super::lock::{Statements, add};
use super::report::{Answer, Verdict};
use super::usage::Usage;

/// What every harness is about.
const LAW: &str = "control/src";
/// What some are about beside it, by the crate's name.
const BESIDE: [(&str, &str); 2] = [
    ("touchstone_protocol", "protocol/src"),
    ("touchstone_drive", "drive/src"),
];
/// What they are built with: the version of the fixed-point numbers.
const BUILT_WITH: &str = "name = \"fixed\"";

/// The numbers of the code that the harnesses of each file can call: the law for all; protocol and drive where the file names
/// them, or names a file that does. As in a statement's number comments and layout do not count, nor do the code's own tests.
pub struct Code(BTreeMap<String, u64>);

/// The number of the control laws' code with the numbers that it is built with.
pub fn law() -> Result<u64, String> {
    let lock = std::fs::read_to_string("Cargo.lock").map_err(|why| format!("Cargo.lock: {why}"))?;
    let package = lock.split("[[package]]").find(|it| it.contains(BUILT_WITH));
    Ok(add(of_folder(LAW)?, package.unwrap_or_default()))
}

impl Code {
    pub fn read() -> Result<Self, String> {
        let law = law()?;
        let mut beside = Vec::new();
        for (name, folder) in BESIDE {
            beside.push((name, of_folder(folder)?));
        }
        // A law's file and its specification's have the same name: what either names counts for both.
        let mut files = BTreeMap::<String, BTreeSet<String>>::new();
        for path in sources("proofs/src")? {
            let name = path.file_stem().unwrap_or_default().to_string_lossy();
            let known = files.entry(name.into_owned()).or_default();
            known.extend(named(&words(tokens(&path)?)));
        }
        let numbers = files.keys().map(|file| {
            let named = reached(file, &files);
            let parts = beside.iter().filter(|(name, _)| named.contains(*name));
            let number = parts.fold(law, |number, (name, part)| {
                add(number, &format!("{name} {part}"))
            });
            (file.clone(), number)
        });
        Ok(Self(numbers.collect()))
    }

    /// The number for a harness such as `tdpa::w8::p7_leaves::proof`.
    fn of(&self, harness: &str) -> String {
        let file = harness.split("::").next().unwrap_or_default();
        format!("{:016x}", self.0.get(file).copied().unwrap_or_default())
    }
}

/// What stands after `crate::` and `super::`, and the names of crates.
fn named(words: &[String]) -> BTreeSet<String> {
    let crates = |word: &&String| BESIDE.iter().any(|(name, _)| word == name);
    let mut found: BTreeSet<String> = words.iter().filter(crates).cloned().collect();
    for (at, word) in words.iter().enumerate() {
        if word != "crate" && word != "super" {
            continue;
        }
        let rest = words[at..].iter().skip(1).skip_while(|word| *word == ":");
        // A group's names are all taken, those in its parts as well.
        let mut depth = 0;
        for word in rest {
            match word.as_str() {
                "Brace" => depth += 1,
                "end" => depth -= 1,
                _ => drop(found.insert(word.clone())),
            }
            if depth <= 0 {
                break;
            }
        }
    }
    found
}

/// All that a file names, and the files that it names.
fn reached(file: &str, files: &BTreeMap<String, BTreeSet<String>>) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut left = vec![file.to_owned()];
    while let Some(file) = left.pop() {
        for word in files.get(&file).into_iter().flatten() {
            // A file of that name, unless it was looked at.
            if found.insert(word.clone()) && files.contains_key(word) {
                left.push(word.clone());
            }
        }
    }
    found
}

fn sources(folder: &str) -> Result<Vec<PathBuf>, String> {
    let mut files = Vec::new();
    let mut left = vec![PathBuf::from(folder)];
    while let Some(path) = left.pop() {
        let said = |why: std::io::Error| format!("{}: {why}", path.display());
        if path.is_dir() {
            for entry in std::fs::read_dir(&path).map_err(said)? {
                left.push(entry.map_err(said)?.path());
            }
        } else if path.extension().is_some_and(|end| end == "rs") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

fn tokens(path: &Path) -> Result<TokenStream, String> {
    let text = std::fs::read_to_string(path).map_err(|why| format!("{}: {why}", path.display()))?;
    text.parse()
        .map_err(|why| format!("{}: {why}", path.display()))
}

fn of_folder(folder: &str) -> Result<u64, String> {
    let mut number = 0;
    for path in sources(folder)? {
        number = add(number, &path.to_string_lossy());
        for word in words(tokens(&path)?) {
            number = add(number, &word);
        }
    }
    Ok(number)
}

/// The tokens, without documentation and without what is compiled for tests only.
fn words(tokens: TokenStream) -> Vec<String> {
    let mut words = Vec::new();
    let mut tokens = tokens.into_iter().peekable();
    while let Some(token) = tokens.next() {
        if token.to_string() == "#" {
            let attribute = tokens.peek().map(ToString::to_string).unwrap_or_default();
            let attribute: String = attribute.split_whitespace().collect();
            if attribute.starts_with("[doc") {
                tokens.next();
                continue;
            }
            if attribute == "[cfg(test)]" {
                // The item that it stands before: to its body or its semicolon.
                let _ = tokens.find(|it| match it {
                    TokenTree::Group(group) => group.delimiter() == Delimiter::Brace,
                    other => other.to_string() == ";",
                });
                continue;
            }
        }
        if let TokenTree::Group(group) = token {
            words.push(format!("{:?}", group.delimiter()));
            words.extend(self::words(group.stream()));
            words.push("end".into());
        } else {
            words.push(token.to_string());
        }
    }
    words
}

/// Adds what was proved within its limits.
pub fn keep(
    memo: &Path,
    found: &BTreeMap<String, Verdict>,
    statements: &Statements,
    fine: impl Fn(&str, &Verdict) -> bool,
) -> Result<(), String> {
    let code = Code::read()?;
    let mut text = std::fs::read_to_string(memo).unwrap_or_default();
    for (name, verdict) in found.iter().filter(|(name, verdict)| fine(name, verdict)) {
        let usage = verdict.usage.unwrap_or_default();
        let row = [
            code.of(name),
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
    let code = Code::read()?;
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
        (*of == code.of(&name) && statements.agree(stated)).then_some((name, verdict))
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
    fn code_is_what_is_compiled_and_can_be_called() {
        let of = |text: &str| words(text.parse().expect("tokens"));
        let before = of("fn f() -> i32 { 1 }");
        let same = "/// Words.\nfn f() -> i32 {\n 1 } #[cfg(test)] mod tests { fn g() {} }";
        assert_eq!(of(same), before);
        for other in [
            "fn f() -> i32 { 2 }",
            "#[cfg(test)] use a::b; fn f() -> i32 { 2 }",
            "#[cfg(not(test))] fn f() -> i32 { 1 }",
        ] {
            assert_ne!(of(other), before, "{other}");
        }
        let file = |name: &str, text: &str| (name.to_owned(), named(&of(text)));
        let files = BTreeMap::from([
            file("device", "use touchstone_drive::angle;"),
            file("helped", "use crate::{a::b, between::{x, y}};"),
            file("between", "use crate::device::y; use crate::helped::z;"),
            file("tdpa", "use touchstone_control::law; fn f(device: i32) {}"),
        ]);
        let names_drive = |name: &str| reached(name, &files).contains("touchstone_drive");
        assert!(names_drive("device") && names_drive("helped") && names_drive("between"));
        assert!(!names_drive("tdpa"));
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
