//! The committed list of harnesses, each with a number of what it states: its body with all that it assumes and claims, what stands
//! beside it in its file, and what stands in every file that this one reaches by `crate::`. A statement that was weakened has another number.
//!
//! The number is of tokens: comments and layout do not count.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use proc_macro2::{Delimiter, TokenStream, TokenTree};

use super::shown::unshown;

pub const LOCK: &str = "proofs/harnesses.lock";
const SOURCES: &str = "proofs/src";
const SPECIFICATION: &str = "proofs/src/spec";
/// The crate itself: its `assert_reached!` is that of every file.
const CRATE: &str = "lib";

/// Whether a macro is one of those that a property is written in: `property!`, `divided_property!`. By a path, `$crate::`, one is handed on.
pub fn writes_a_property(name: &str) -> bool {
    !name.contains(':') && (name == "property" || name.ends_with("_property"))
}

/// What a property or its file names after `by`.
const SOLVERS: [&str; 6] = ["cadical", "minisat", "kissat", "cvc5", "z3", "sampled"];

/// The number of each property, by file and name: `tdpa::p7_leaves`.
pub struct Statements(BTreeMap<String, u64>);

/// FNV-1a.
pub fn add(hash: u64, text: &str) -> u64 {
    text.bytes().chain([0]).fold(hash, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}
const EMPTY: u64 = 0xcbf2_9ce4_8422_2325;

impl Statements {
    /// Of the sources in the workspace.
    pub fn read() -> Result<Self, String> {
        let mut files = BTreeMap::new();
        for (folder, prefix) in [(SOURCES, ""), (SPECIFICATION, "spec/")] {
            let said = |why: std::io::Error| format!("{folder}: {why}");
            for entry in std::fs::read_dir(folder).map_err(said)? {
                let path = entry.map_err(said)?.path();
                if path.is_dir() && path != Path::new(SPECIFICATION) {
                    return Err(format!(
                        "{}: a folder that the gate does not read",
                        path.display()
                    ));
                }
                if path.extension().is_some_and(|end| end == "rs") {
                    let text = std::fs::read_to_string(&path).map_err(said)?;
                    files.insert(format!("{prefix}{}", name(&path)), text);
                }
            }
        }
        for (file, text) in &files {
            if let Some(line) = unshown(text)?.first() {
                return Err(format!(
                    "{SOURCES}/{file}.rs:{line}: no `cover!` is a statement after this assertion in its block, so nothing shows that it is reached: `assert_reached!`"
                ));
            }
        }
        Self::of(&files)
    }

    /// For tests: no source at all.
    #[cfg(test)]
    pub fn of_nothing() -> Self {
        Self(BTreeMap::new())
    }

    fn of(files: &BTreeMap<String, String>) -> Result<Self, String> {
        let mut looked = BTreeMap::new();
        for (file, text) in files {
            looked.insert(file.as_str(), looked_at(file, text)?);
        }
        let mut numbers = BTreeMap::<String, u64>::new();
        for (file, own) in &looked {
            let mut shared = EMPTY;
            for reached in reached(file, &looked) {
                shared = add(add(shared, reached), &looked[reached].beside.to_string());
            }
            for (property, number) in &own.properties {
                let all = [shared, *number].map(|number| number.to_string());
                let number = all.iter().fold(EMPTY, |hash, text| add(hash, text));
                // Two modules of a file may have one of the same name: then each is a part of the number.
                numbers
                    .entry(format!("{file}::{property}"))
                    .and_modify(|other| *other = add(*other, &number.to_string()))
                    .or_insert(number);
            }
        }
        Ok(Self(numbers))
    }

    /// The line of a harness such as `tdpa::w8::p7_leaves::proof`.
    pub fn line(&self, harness: &str) -> String {
        let number = self.0.get(&property(harness)).copied();
        format!("{harness} {:016x}", number.unwrap_or_default())
    }

    /// Whether a line of the lock has the number that the sources have.
    pub fn agree(&self, line: &str) -> bool {
        line.split(' ')
            .next()
            .is_some_and(|harness| self.line(harness) == line)
    }
}

/// A file, and all that it reaches: files whose names, or whose macros, follow `crate::` in it, and so on. The specification counts as one.
fn reached<'a>(file: &'a str, looked: &'a BTreeMap<&'a str, Looked>) -> BTreeSet<&'a str> {
    let mut found = BTreeSet::new();
    let mut waiting = vec![file, CRATE];
    while let Some(next) = waiting.pop() {
        let Some((name, of)) = looked.get_key_value(next) else {
            continue;
        };
        if !found.insert(*name) {
            continue;
        }
        for (other, it) in looked {
            let part = other.split('/').next().unwrap_or_default();
            if of.reaches.contains(part) || it.macros.iter().any(|name| of.reaches.contains(name)) {
                waiting.push(other);
            }
        }
    }
    found
}

fn name(path: &Path) -> String {
    path.file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

/// `tdpa::w8::p7_leaves::proof` is of `tdpa::p7_leaves`.
fn property(harness: &str) -> String {
    let parts: Vec<&str> = harness.trim_end_matches("::proof").split("::").collect();
    let (first, last) = (parts.first(), parts.last());
    format!("{}::{}", first.unwrap_or(&""), last.unwrap_or(&""))
}

/// One file: the number of each property, and of everything beside them; its macros, and what follows `crate::` in it.
struct Looked {
    properties: Vec<(String, u64)>,
    beside: u64,
    macros: BTreeSet<String>,
    reaches: BTreeSet<String>,
}

impl Looked {
    const fn nothing() -> Self {
        Self {
            properties: Vec::new(),
            beside: EMPTY,
            macros: BTreeSet::new(),
            reaches: BTreeSet::new(),
        }
    }
}

fn looked_at(file: &str, text: &str) -> Result<Looked, String> {
    let tokens: TokenStream = text.parse().map_err(|why| format!("{file}.rs: {why}"))?;
    let mut looked = Looked::nothing();
    refer(&tokens, &mut looked);
    look(tokens, &mut looked);
    Ok(looked)
}

/// Names of macros that are made here, and what follows `crate::`: a name, or in braces several.
fn refer(tokens: &TokenStream, into: &mut Looked) {
    let tokens: Vec<TokenTree> = tokens.clone().into_iter().collect();
    let is = |at: usize, text: &str| {
        tokens
            .get(at)
            .is_some_and(|token| token.to_string() == text)
    };
    for (at, token) in tokens.iter().enumerate() {
        if let TokenTree::Group(group) = token {
            refer(&group.stream(), into);
        }
        if is(at, "macro_rules") && is(at + 1, "!") {
            into.macros
                .extend(tokens.get(at + 2).map(ToString::to_string));
        }
        if is(at, "crate") && is(at + 1, ":") && is(at + 2, ":") {
            match tokens.get(at + 3) {
                Some(TokenTree::Group(group)) => {
                    let mut begins = true;
                    for token in group.stream() {
                        let text = token.to_string();
                        if begins {
                            into.reaches.insert(text.clone());
                        }
                        begins = text == ",";
                    }
                }
                other => into.reaches.extend(other.map(ToString::to_string)),
            }
        }
    }
}

/// Walks through the tokens and the groups in them; `property! { ... }` is taken out, so that one more is no change of the others.
fn look(tokens: TokenStream, into: &mut Looked) {
    let tokens: Vec<TokenTree> = tokens.into_iter().collect();
    let word = |at: usize| tokens.get(at).map(ToString::to_string).unwrap_or_default();
    let mut at = 0;
    while let Some(token) = tokens.get(at) {
        // Documentation is an attribute by now.
        if word(at) == "#" && is_doc(&word(at + 1)) {
            at += 2;
            continue;
        }
        // A file's own.
        if word(at) == "#" && word(at + 1) == "!" && is_doc(&word(at + 2)) {
            at += 3;
            continue;
        }
        if writes_a_property(&word(at))
            && word(at + 1) == "!"
            && let Some(TokenTree::Group(group)) = tokens.get(at + 2)
            && group.delimiter() == Delimiter::Brace
        {
            // What a macro hands on to another is none.
            if let Some(property) = one(group.stream()) {
                into.properties.push(property);
                at += 3;
                continue;
            }
        }
        match token {
            TokenTree::Group(group) => {
                into.beside = add(into.beside, &format!("{:?}", group.delimiter()));
                look(group.stream(), into);
                into.beside = add(into.beside, "end");
            }
            // Who proves it, or that nobody does, is no part of what is stated.
            TokenTree::Ident(word) if SOLVERS.contains(&word.to_string().as_str()) => {}
            other => into.beside = add(into.beside, &other.to_string()),
        }
        at += 1;
    }
}

fn is_doc(group: &str) -> bool {
    let inner = group.trim_start_matches('[').trim_start();
    group.starts_with('[') && inner.starts_with("doc")
}

/// A property: the name after `fn`, and the number of all of it but its documentation.
fn one(tokens: TokenStream) -> Option<(String, u64)> {
    let mut inner = Looked::nothing();
    let words: Vec<String> = tokens
        .clone()
        .into_iter()
        .map(|token| token.to_string())
        .collect();
    look(tokens, &mut inner);
    let at = words.iter().position(|word| word == "fn")?;
    let name = words.get(at + 1).filter(|name| *name != "$")?;
    Some((name.clone(), inner.beside))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(law: &str, valid: &str) -> Statements {
        let file = |name: &str, text: &str| (name.to_owned(), text.to_owned());
        let law = format!("use crate::valid::valid; {law}");
        Statements::of(&BTreeMap::from([file("law", &law), file("valid", valid)])).expect("tokens")
    }

    const LAW: &str = "
        fn helper() -> i32 { 1 }
        macro_rules! law { ($m:ident) => { pub mod $m {
            property! {
                /// P1: words.
                equation \"a = b\" over \"all\" by cadical fn p1_a(s) { assume!(s, x > 0, \"why\"); assert!(y > helper()); }
            }
            property! { equation \"c\" over \"all\" fn p2_b(s) { assert!(true); } }
        } } }";

    #[test]
    fn who_proves_it_is_no_part_of_a_statement() {
        let by_another = LAW.replace("cadical", "sampled");
        assert!(by_another != LAW);
        assert_eq!(numbers(LAW, "").0, numbers(&by_another, "").0);
    }

    #[test]
    fn of_two_with_one_name_each_is_a_part_of_the_number() {
        let two = |first: &str| {
            let law = format!(
                "mod a {{ property! {{ fn p1_a(s) {{ assert!({first}); }} }} }} mod b {{ property! {{ fn p1_a(s) {{ assert!(y); }} }} }}"
            );
            numbers(&law, "").line("law::a::p1_a::proof")
        };
        assert_ne!(two("x > 0"), two("true"));
    }

    /// By name, in braces, through another file, by a macro, and through the specification's own folder: what is reached is a part of the number,
    /// and what is not is none.
    #[test]
    fn what_a_file_reaches_is_a_part_of_its_statements() {
        let property = "property! { equation \"a\" over \"b\" fn p11_x(s) { assert!(true); } }";
        let files = |changed: &str| {
            let uses = |what: &str| format!("use {what}; {property}");
            let made = |name: &str, text: &str| {
                let with = if name == changed { " fn more() {}" } else { "" };
                (name.to_owned(), format!("{text}{with}"))
            };
            let all = [
                made("by_name", &uses("crate::guard::valid")),
                made("in_braces", &uses("crate::{assume, guard::valid}")),
                made("through", &uses("crate::by_name")),
                made("by_macro", &uses("crate::stage_property")),
                made("spec_user", &uses("crate::spec::tdpa")),
                made("alone", property),
                made("guard", "fn valid() {}"),
                made(
                    "stage",
                    "macro_rules! stage_property { () => { $crate::guard::valid } }",
                ),
                made("spec/tdpa", "fn tick() {}"),
                made("lib", "macro_rules! assert { () => {} }"),
            ];
            Statements::of(&BTreeMap::from(all)).expect("tokens").0
        };
        let before = files("");
        let changed = |file: &str| -> Vec<String> {
            let after = files(file);
            let other = before
                .iter()
                .filter(|(name, number)| after[*name] != **number);
            other
                .map(|(name, _)| name.trim_end_matches("::p11_x").to_owned())
                .collect()
        };
        assert_eq!(
            changed("guard"),
            ["by_macro", "by_name", "in_braces", "through"]
        );
        assert_eq!(changed("stage"), ["by_macro"]);
        assert_eq!(changed("by_name"), ["by_name", "through"]);
        assert_eq!(changed("spec/tdpa"), ["spec_user"]);
        assert_eq!(changed("alone"), ["alone"]);
        assert_eq!(changed("lib").len(), 6);
    }

    #[test]
    fn what_is_stated_has_a_number_and_what_is_said_of_it_has_none() {
        let before = numbers(LAW, "fn valid() {}");
        let line = |it: &Statements| it.line("law::w8::p1_a::proof");
        assert_eq!(
            before.0.keys().collect::<Vec<_>>(),
            ["law::p1_a", "law::p2_b"]
        );
        assert!(before.agree(&line(&before)) && !before.agree("law::w8::p1_a::proof"));
        for same in [
            LAW.replace("P1: words.", "Other words."),
            LAW.replace("            ", "\n"),
            format!("\n//! Of a whole file.\n{LAW}"),
        ] {
            assert_eq!(line(&numbers(&same, "fn valid() {}")), line(&before));
        }
        // A weaker assertion, a stronger assumption, a weaker helper, a weaker invariant: each is another statement.
        for other in [
            LAW.replace("y > helper", "y >= helper"),
            LAW.replace("x > 0", "x > 1"),
            LAW.replace("{ 1 }", "{ 0 }"),
            LAW.replace("a = b", "a = c"),
        ] {
            assert_ne!(
                line(&numbers(&other, "fn valid() {}")),
                line(&before),
                "{other}"
            );
        }
        assert_ne!(line(&numbers(LAW, "fn valid() { true }")), line(&before));
        // A change of one property is none of another, nor is one more.
        let more = "property! { equation \"d\" over \"all\" fn p3_d(s) { assert!(false); } } } } }";
        for other in [LAW.replace("x > 0", "x > 1"), LAW.replace("} } }", more)] {
            assert!(other != LAW);
            assert_eq!(
                numbers(&other, "fn valid() {}").line("law::w8::p2_b::proof"),
                before.line("law::w8::p2_b::proof")
            );
        }
    }
}
