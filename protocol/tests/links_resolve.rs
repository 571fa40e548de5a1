//! Checks that every relative link in the repository's Markdown leads to a file, and every anchor to a heading.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    root.canonicalize().expect("the repository")
}

fn pages(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().expect("a name").to_string_lossy();
        if path.is_dir() {
            if name != "target" && name != "node_modules" && !name.starts_with('.') {
                pages(&path, found);
            }
        } else if name.ends_with(".md") {
            found.push(path);
        }
    }
}

/// The lines of a Markdown page without its code blocks.
fn prose(page: &str) -> Vec<&str> {
    let mut code = false;
    let outside = |line: &&str| {
        let fence = line.trim_start().starts_with("```");
        code ^= fence;
        !fence && !code
    };
    page.lines().filter(outside).collect()
}

/// A Markdown line without its inline code.
fn unquoted(line: &str) -> String {
    line.split('`').step_by(2).collect()
}

/// A Markdown heading with each link replaced by the link's text.
fn shown(heading: &str) -> String {
    let mut out = String::new();
    let mut rest = heading;
    while let Some((before, after)) = rest.split_once("](") {
        out += &before.replacen('[', "", 1);
        rest = after.split_once(')').map_or("", |(_, after)| after);
    }
    out + rest
}

/// The anchors that a Markdown renderer gives the headings of a page.
fn anchors(page: &str) -> BTreeSet<String> {
    let mut seen = BTreeMap::<String, usize>::new();
    let mut found = BTreeSet::new();
    for line in prose(page).into_iter().filter(|line| line.starts_with('#')) {
        let kept: String = shown(line.trim_start_matches('#').trim())
            .to_lowercase()
            .chars()
            .filter(|c| c.is_alphanumeric() || " -_".contains(*c))
            .map(|c| if c == ' ' { '-' } else { c })
            .collect();
        let times = seen.entry(kept.clone()).or_default();
        found.insert(match *times {
            0 => kept,
            n => format!("{kept}-{n}"),
        });
        *times += 1;
    }
    found
}

/// The targets of the links on a Markdown page that lead into the repository.
fn links(page: &str) -> Vec<String> {
    let mut found = Vec::new();
    for line in prose(page) {
        for part in unquoted(line).split("](").skip(1) {
            let Some((link, _)) = part.split_once(')') else {
                continue;
            };
            if !link.contains("://") && !link.starts_with("mailto:") {
                found.push(link.to_owned());
            }
        }
    }
    found
}

fn dead(page: &Path, link: &str) -> Option<&'static str> {
    let (path, anchor) = link.split_once('#').unwrap_or((link, ""));
    let target = match path {
        "" => page.to_owned(),
        path => page.parent().expect("a folder").join(path),
    };
    if !target.exists() {
        return Some("no such file");
    }
    let is_page = target.extension().is_some_and(|end| end == "md");
    if anchor.is_empty() || !is_page {
        return None;
    }
    let text = std::fs::read_to_string(&target).expect("a page");
    (!anchors(&text).contains(anchor)).then_some("no such heading")
}

#[test]
fn every_link_of_a_page_leads_somewhere() {
    let mut all = Vec::new();
    pages(&root(), &mut all);
    let (mut count, mut wrong) = (0, Vec::new());
    for page in &all {
        let text = std::fs::read_to_string(page).expect("a page");
        for link in links(&text) {
            count += 1;
            if let Some(why) = dead(page, &link) {
                wrong.push(format!("{}: {link}: {why}", page.display()));
            }
        }
    }
    assert!(count > 300, "{count} links of {} pages", all.len());
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_dead_link_is_noticed() {
    let readme = root().join("README.md");
    assert_eq!(dead(&readme, "docs/no-such-page.md"), Some("no such file"));
    assert_eq!(dead(&readme, "docs/words.md#laws"), None);
    assert_eq!(dead(&readme, "docs/words.md#lawz"), Some("no such heading"));
    assert_eq!(links("a [b](c.md#d), `[e](f)`, [g](https://h)"), ["c.md#d"]);
}

/// The tests that the commands of a page run: each a file of `tests/tests/all` and the beginning of a test's name, from
/// `-p touchstone-tests file::name`.
fn run_tests(page: &str) -> Vec<(&str, &str)> {
    page.split("-p touchstone-tests ")
        .skip(1)
        .filter_map(|rest| rest.split([' ', '`', '\n']).next()?.split_once("::"))
        .collect()
}

/// `cargo test` with a name that no test has runs nothing and succeeds.
#[test]
fn every_command_of_a_page_runs_a_test() {
    let mut all = Vec::new();
    pages(&root(), &mut all);
    let mut count = 0;
    for page in &all {
        let text = std::fs::read_to_string(page).expect("a page");
        for (file, name) in run_tests(&text) {
            count += 1;
            let source = root().join(format!("tests/tests/all/{file}.rs"));
            let source = std::fs::read_to_string(source).unwrap_or_default();
            assert!(
                source.contains(&format!("#[test]\nfn {name}")),
                "{}: no test {file}::{name} in tests/tests/all",
                page.display()
            );
        }
    }
    assert!(count > 10, "{count} commands");
    assert_eq!(
        run_tests("(`-p touchstone-tests a::b -- -c`)"),
        [("a", "b")]
    );
}

#[test]
fn every_page_is_in_the_book() {
    let docs = root().join("docs");
    let summary = std::fs::read_to_string(docs.join("SUMMARY.md")).expect("the book's contents");
    let mut all = Vec::new();
    pages(&docs, &mut all);
    for page in all {
        let name = page.strip_prefix(&docs).expect("in docs").to_string_lossy();
        let entry = format!("]({})", name.replace('\\', "/"));
        assert!(
            name == "SUMMARY.md" || summary.contains(&entry),
            "docs/SUMMARY.md has no line for {name}"
        );
    }
}
