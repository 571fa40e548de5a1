//! Checks that `proofs/harnesses.md` lists every harness (proof) of `proofs/harnesses.lock`, with the equation from its source, and
//! no others. Also checks that code which the page quotes exists in the source.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

const PAGE: &str = "proofs/harnesses.md";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn read(path: impl AsRef<Path>) -> String {
    let path = root().join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|why| panic!("{}: {why}", path.display()))
}

/// The harnesses (proofs) of the lock file, such as `tdpa::p7_leaves`, each with the modules in which it is proved. The file's
/// lines look like `tdpa::w8::p7_leaves::proof`.
fn locked() -> BTreeMap<String, Vec<String>> {
    let mut found = BTreeMap::<String, Vec<String>>::new();
    for line in read("proofs/harnesses.lock").lines() {
        let (name, _) = line.split_once(' ').expect("a name and a number");
        let parts: Vec<&str> = name.split("::").collect();
        let [file, instance @ .., name, "proof"] = parts.as_slice() else {
            panic!("harnesses.lock: {line}");
        };
        let instance = match instance {
            [] => "one".into(),
            modules => modules.join("::"),
        };
        found
            .entry(format!("{file}::{name}"))
            .or_default()
            .push(instance);
    }
    found
}

/// The equation of each property in the sources, by the property's name.
fn equations() -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(root().join("proofs/src")).expect("the proofs") {
        let path = entry.expect("readable").path();
        let file = path.file_stem().expect("a file").to_string_lossy();
        // `source.rs` defines the macros and has no properties.
        if file == "source" || path.is_dir() {
            continue;
        }
        let text = std::fs::read_to_string(&path).expect("readable");
        for property in text.split("property! {").skip(1) {
            // A macro that passes its tokens on has no equation.
            let Some((_, rest)) = property.split_once("equation \"") else {
                continue;
            };
            let (equation, rest) = rest.split_once("\"\n").expect("its end");
            let (_, rest) = rest.split_once("fn ").expect("a body");
            let (name, _) = rest.split_once('(').expect("its argument");
            found.insert(format!("{file}::{name}"), equation.to_owned());
        }
    }
    found
}

/// The part of a property's row in the page's table that follows the meaning in plain words.
fn row(harness: &str, equation: &str, instances: &[String]) -> String {
    let (file, _) = harness.split_once("::").expect("file and name");
    let equation = equation.replace('|', "\\|");
    let instances = instances.join(", ");
    format!(" | `{equation}` | [`{harness}`](src/{file}.rs) | {instances} |")
}

#[test]
fn every_harness_has_its_row_and_every_row_its_harness() {
    let page = read(PAGE);
    let (_, index) = page.split_once("<!-- index -->").expect("the index");
    let (index, _) = index.split_once("<!-- end of index -->").expect("its end");
    let mut rows: Vec<&str> = index
        .lines()
        .filter(|line| line.starts_with("| ") && line.contains("](src/"))
        .collect();
    let (locked, equations) = (locked(), equations());
    assert!(locked.len() > 50, "{} harnesses in the lock", locked.len());
    for (harness, instances) in &locked {
        let equation = equations
            .get(harness)
            .unwrap_or_else(|| panic!("{harness} of the lock is no property of the sources"));
        let expected = row(harness, equation, instances);
        let at = rows
            .iter()
            .position(|row| row.ends_with(&expected))
            .unwrap_or_else(|| panic!("{PAGE} has no row\n| (plain words){expected}"));
        let words = rows.swap_remove(at).trim_end_matches(&expected);
        assert!(words.len() > 10, "{PAGE}: no words for {harness}");
    }
    assert!(
        rows.is_empty(),
        "{PAGE} has rows that are not in proofs/harnesses.lock: {rows:#?}"
    );
}

#[test]
fn every_property_that_is_tried_on_all_inputs_has_its_row() {
    let page = read(PAGE);
    let (_, index) = page.split_once("<!-- every -->").expect("the table");
    let (index, _) = index.split_once("<!-- end of every -->").expect("its end");
    let program = read("proofs/examples/every.rs");
    let equations = equations();
    let mut names = Vec::new();
    for rest in program.split("every!(").skip(1) {
        let (name, _) = rest.split_once(')').expect("a name");
        names.push(name);
        let parts: Vec<&str> = name.split("::").collect();
        let (file, last) = (parts[0], parts[parts.len() - 1]);
        let equation = &equations[&format!("{file}::{last}")].replace('|', "\\|");
        let row = format!(" | `{equation}` | [`{name}`](src/{file}.rs) |");
        assert!(
            index.lines().any(|line| line.ends_with(&row)),
            "{PAGE} has no row\n| (plain words){row}"
        );
    }
    assert!(names.len() > 30, "{} properties", names.len());
    let rows = index.lines().filter(|line| line.contains("](src/")).count();
    assert_eq!(
        rows,
        names.len(),
        "rows of properties that are not tried any more"
    );
}

#[test]
fn the_walk_quotes_what_is_there_in_its_order() {
    let page = read(PAGE);
    let source = read("proofs/src/tdpa.rs");
    let name = source.find("fn p1_exact_is_the_sum").expect("the harness");
    let begin = source[..name].rfind("property! {").expect("its property");
    let (_, body) = source[begin..].split_once('{').expect("its beginning");
    let (body, _) = body.split_once("property! {").expect("the one after it");
    let mut lines = body.lines().map(str::trim);
    let mut quoted = 0;
    for block in page.split("```rust\n").skip(1) {
        let (block, _) = block.split_once("```").expect("its end");
        for line in block.lines() {
            assert!(
                lines.any(|there| there == line),
                "{PAGE} quotes `{line}`, which is not there, or not at this place"
            );
            quoted += 1;
        }
    }
    assert!(quoted > 15, "{quoted} lines quoted");
}
