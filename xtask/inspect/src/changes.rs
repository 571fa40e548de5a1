//! Reads the lists of deliberately wrong changes that proofs and tests must detect: `proofs/mutants.toml`,
//! `proofs/coq/mutants.toml` and `emulator/sabotage.toml`.
//!
//! The launcher `cargo xtask` receives a list as lines of key, tab and text, in the order of the file. The key `next` begins an
//! entry. The last keys of an entry are `file`, `find` and `replace` for each of its changes.

use serde::Deserialize;

use crate::answer::Answer;

/// Content of one list of wrong changes: `mutant` for the proofs, `sabotage` for the emulator. Each file fills one of the two
/// fields.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct List {
    #[serde(default)]
    mutant: Vec<Mutant>,
    #[serde(default)]
    sabotage: Vec<Sabotage>,
}

/// A wrong change of the code that a proof or a test must detect.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Mutant {
    file: String,
    find: String,
    replace: String,
    /// Name of the proof (harness) that must refute the change; may be empty if a test is named.
    #[serde(default)]
    harness: String,
    /// The test that must fail with the change, as `package name` or `package --features=feature name`; may be empty if a proof
    /// (harness) is named.
    #[serde(default)]
    test: String,
}

/// A change that removes one safety function from the firmware.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Sabotage {
    /// Name of the removed safety function.
    name: String,
    /// Name of the board whose firmware is changed.
    board: String,
    /// Text for `cargo xtask fil --only` that selects the check that must fail.
    only: String,
    /// Text that must appear in the line that reports the failed check.
    says: String,
    change: Vec<Change>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Change {
    file: String,
    find: String,
    replace: String,
}

/// Keys and texts of an entry of a list, in the order in which they are printed.
type Lines<'l> = Vec<(&'static str, &'l str)>;

impl Mutant {
    fn lines(&self) -> Lines<'_> {
        vec![
            ("harness", &self.harness),
            ("test", &self.test),
            ("file", &self.file),
            ("find", &self.find),
            ("replace", &self.replace),
        ]
    }
}

impl Sabotage {
    fn lines(&self) -> Lines<'_> {
        let mut lines: Lines = vec![
            ("name", &self.name),
            ("board", &self.board),
            ("only", &self.only),
            ("says", &self.says),
        ];
        for change in &self.change {
            lines.push(("file", &change.file));
            lines.push(("find", &change.find));
            lines.push(("replace", &change.replace));
        }
        lines
    }
}

/// Prints a list of wrong changes from the text of its TOML file. Errors: the text is not such a list.
pub fn print(text: &str) -> Result<Answer, String> {
    let list: List = toml::from_str(text).map_err(|why| why.to_string())?;
    let sabotages = list.sabotage.iter().map(Sabotage::lines);
    let entries: Vec<Lines> = list
        .mutant
        .iter()
        .map(Mutant::lines)
        .chain(sabotages)
        .collect();
    for entry in &entries {
        println!("next\t");
        for (key, value) in entry {
            if value.contains(['\u{2028}', '\t']) {
                return Err(format!("`{value}` has a line separator or a tab in it"));
            }
            // A value is printed on one line; `xtask` restores its line breaks.
            println!("{key}\t{}", value.replace('\n', "\u{2028}"));
        }
    }
    Ok(Answer::Right(format!("{} entries", entries.len())))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(path: &str) -> String {
        let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        std::fs::read_to_string(root.join(path)).unwrap_or_else(|why| panic!("{path}: {why}"))
    }

    fn list(path: &str) -> List {
        toml::from_str(&read(path)).expect("a list")
    }

    fn fits(file: &str, find: &str, replace: &str) {
        assert_eq!(read(file).matches(find).count(), 1, "{file}: `{find}`");
        assert_ne!(find, replace);
    }

    /// Checks that each mutant (wrong change) fits the sources, changes something, and names an existing proof or a test.
    #[test]
    fn the_mutants_fit_the_sources() {
        let (mutants, locked) = (
            list("proofs/mutants.toml").mutant,
            read("proofs/harnesses.lock"),
        );
        assert!(!mutants.is_empty());
        for mutant in &mutants {
            fits(&mutant.file, &mutant.find, &mutant.replace);
            let mut names = locked.lines().filter_map(|line| line.split(' ').next());
            let is_locked = names.any(|name| name == mutant.harness);
            let by_test = mutant.harness.is_empty() && !mutant.test.is_empty();
            assert!(is_locked || by_test, "{mutant:?}");
        }
    }

    /// Checks that each wrong change of the theorems fits the Coq files, and names an existing one.
    #[test]
    fn the_wrong_changes_of_the_theorems_fit_the_sources() {
        let mutants = list("proofs/coq/mutants.toml").mutant;
        assert!(!mutants.is_empty());
        for mutant in &mutants {
            fits(&mutant.file, &mutant.find, &mutant.replace);
            read(&format!("proofs/coq/{}", mutant.harness));
        }
    }

    /// Checks that each sabotage (removal of a safety function) has all fields and fits the sources.
    #[test]
    fn the_sabotages_fit_the_sources() {
        let sabotages = list("emulator/sabotage.toml").sabotage;
        assert!(!sabotages.is_empty());
        for one in &sabotages {
            let words = [&one.name, &one.board, &one.only, &one.says];
            assert!(words.iter().all(|word| !word.is_empty()), "{one:?}");
            assert!(!one.change.is_empty(), "{one:?}");
            for change in &one.change {
                fits(&change.file, &change.find, &change.replace);
            }
        }
    }

    #[test]
    fn a_misspelt_key_is_refused() {
        let text = "[[mutant]]\nfile = 'a'\nfind = 'b'\nreplace = 'c'\nharnes = 'd'\n";
        assert!(print(text).unwrap_err().contains("harnes"));
        assert!(print("[[mutan]]\n").is_err());
    }

    #[test]
    fn a_text_that_would_break_the_lines_is_refused() {
        let text = "[[mutant]]\nfile = 'a'\nfind = \"b\\tb\"\nreplace = 'c'\nharness = 'd'\n";
        assert!(print(text).unwrap_err().contains("a tab"));
    }
}
