//! Checks that every fault code has a page with its number and name and with all sections, that the index lists all pages, and that
//! there are no others.

use std::path::{Path, PathBuf};
use touchstone_protocol::{FaultCode, Limit};

const SECTIONS: [&str; 5] = [
    "## Meaning",
    "**Value:**",
    "## Likely causes",
    "## What to check",
    "## How to clear",
];

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs")
}

/// The fault's name in file names, e.g. `over-current` for `OverCurrent`.
fn name(code: FaultCode) -> String {
    let mut name = String::new();
    for letter in format!("{code:?}").chars() {
        if letter.is_ascii_uppercase() && !name.is_empty() {
            name.push('-');
        }
        name.push(letter.to_ascii_lowercase());
    }
    name
}

#[test]
fn every_code_has_a_page_with_all_sections_and_a_row_in_the_index() {
    let index = std::fs::read_to_string(docs().join("faults.md")).expect("docs/faults.md");
    for code in FaultCode::ALL {
        let (number, name) = (code.to_wire(), name(code));
        let file = format!("faults/{number:02}-{name}.md");
        let page = std::fs::read_to_string(docs().join(&file)).expect(&file);
        assert!(
            page.starts_with(&format!("# Fault {number:02}: {name}\n")),
            "{file}"
        );
        // The page has each section, in this order, and no section is empty.
        let mut rest = page.as_str();
        for section in SECTIONS {
            let (before, after) = rest
                .split_once(section)
                .unwrap_or_else(|| panic!("{file} has no {section} in its place"));
            assert!(before.trim().len() > 10, "{file}: nothing before {section}");
            rest = after;
        }
        assert!(rest.trim().len() > 10, "{file}: nothing at its end");
        assert!(
            index.contains(&format!("| [{number:02}]({file}) | {name} |")),
            "docs/faults.md has no row for {file}"
        );
    }
}

#[test]
fn there_are_no_other_pages_and_every_limit_is_named() {
    let pages = std::fs::read_dir(docs().join("faults")).expect("docs/faults");
    assert_eq!(pages.count(), FaultCode::ALL.len());
    let index = std::fs::read_to_string(docs().join("faults.md")).expect("docs/faults.md");
    for limit in Limit::ALL {
        let name = format!("`{}`", format!("{limit:?}").to_lowercase());
        assert!(index.contains(&name), "{name}");
    }
}
