//! The committed list of harnesses, each with a number of what it states: its body with all that it assumes and claims, what stands
//! beside it in its file, and what every file shares. A statement that was weakened has another number.
//!
//! The number is of tokens: comments and layout do not count.

use std::collections::BTreeMap;
use std::path::Path;

use proc_macro2::{Delimiter, TokenStream, TokenTree};

pub const LOCK: &str = "proofs/harnesses.lock";
const SOURCES: &str = "proofs/src";
/// What every statement rests on: configurations and memories, sources of inputs, number formats.
const SHARED: [&str; 5] = ["valid", "source", "format", "facts", "functions"];
/// Whose statements are comparisons with a specification, and what they rest on beside that: the specification.
const COMPARES: [&str; 7] = [
    "refines",
    "refines_enhanced",
    "estimated",
    "velocity",
    "set",
    "set_laws",
    "set_space",
];
const SPECIFICATION: &str = "proofs/src/spec";
const BRIDGE: &str = "specified";
/// And the divisions, multiplications and pieces of ticks of those that have shared ones.
const REPLACED: [&str; 3] = ["divided", "multiplied", "pieces"];

/// And the estimator's and the velocity filters', with the products and pieces of their own, and what a motion is.
const ESTIMATES: [&str; 2] = ["estimated", "velocity"];
const WEIGHED: [&str; 3] = ["weighed", "estimator", "estimated"];

/// And what settings become, with their products and quotients.
const BECOMES: [&str; 3] = ["set", "set_laws", "set_space"];
const RECKONED: [&str; 5] = ["reckoned", "answers", "stand_ins", "estimated", "accepted"];

/// What a property is written in.
pub const MACROS: [&str; 20] = [
    "property",
    "divided_property",
    "multiplied_property",
    "booked_property",
    "composed_property",
    "first_property",
    "settings_property",
    "any_law_property",
    "weighed_property",
    "flowed_property",
    "corrected_property",
    "bounded_property",
    "placed_property",
    "reckoned_property",
    "validated_property",
    "timed_property",
    "flow_property",
    "limited_property",
    "guarded_property",
    "lawful_property",
];

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
                if path.extension().is_some_and(|end| end == "rs") {
                    let text = std::fs::read_to_string(&path).map_err(said)?;
                    files.insert(format!("{prefix}{}", name(&path)), text);
                }
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
        let mut shared = EMPTY;
        for file in SHARED {
            shared = looked_at(file, text_of(files, file))?
                .beside
                .wrapping_add(add(shared, file));
        }
        let mut specification = EMPTY;
        for (file, text) in files {
            let of_comparisons = file == BRIDGE || REPLACED.contains(&file.as_str());
            if of_comparisons || file.starts_with("spec/") {
                let beside = looked_at(file, text)?.beside;
                specification = beside.wrapping_add(add(specification, file));
            }
        }
        let mut numbers = BTreeMap::<String, u64>::new();
        for (file, text) in files {
            let found = looked_at(file, text)?;
            let mut shared = shared;
            if COMPARES.contains(&file.as_str()) {
                shared ^= specification;
            }
            if ESTIMATES.contains(&file.as_str()) {
                for of in WEIGHED {
                    shared ^= add(looked_at(of, text_of(files, of))?.beside, of);
                }
            }
            if BECOMES.contains(&file.as_str()) {
                for of in RECKONED {
                    shared ^= add(looked_at(of, text_of(files, of))?.beside, of);
                }
            }
            for (property, number) in found.properties {
                let all = [shared, found.beside, number].map(|number| number.to_string());
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

fn text_of<'a>(files: &'a BTreeMap<String, String>, file: &str) -> &'a str {
    files.get(file).map_or("", String::as_str)
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

/// One file: the number of each property, and of everything beside them.
struct Looked {
    properties: Vec<(String, u64)>,
    beside: u64,
}

fn looked_at(file: &str, text: &str) -> Result<Looked, String> {
    let tokens: TokenStream = text.parse().map_err(|why| format!("{file}.rs: {why}"))?;
    let mut looked = Looked {
        properties: Vec::new(),
        beside: EMPTY,
    };
    look(tokens, &mut looked);
    Ok(looked)
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
        if MACROS.contains(&word(at).as_str())
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
    let mut inner = Looked {
        properties: Vec::new(),
        beside: EMPTY,
    };
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
        Statements::of(&BTreeMap::from([file("law", law), file("valid", valid)])).expect("tokens")
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

    #[test]
    fn a_comparison_is_also_of_its_specification() {
        let property = "property! { equation \"a\" over \"b\" fn p11_x(s) { assert!(true); } }";
        let number = |specification: &str| {
            let files = [
                ("refines", property),
                ("tdpa", property),
                ("spec/tdpa", specification),
            ];
            let files = files.map(|(name, text)| (name.to_owned(), text.to_owned()));
            let all = Statements::of(&BTreeMap::from(files)).expect("tokens");
            ["refines", "tdpa"].map(|file| all.line(&format!("{file}::w8::p11_x::proof")))
        };
        let (before, after) = (number("fn f() -> i32 { 1 }"), number("fn f() -> i32 { 2 }"));
        assert!(before[0] != after[0] && before[1] == after[1]);
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
