//! Checks that every control law is named in each file where the compiler does not report a missing law.

use std::path::{Path, PathBuf};
use touchstone_control::{Choice, LawKind, Settings};

/// Files that must contain the Rust name of every law: tables and lists that a match over the laws does not complete.
const IN_RUST: [&str; 9] = [
    "control/src/controller.rs",
    "host-sim/report/src/label.rs",
    "host-sim/report/src/picture.rs",
    "host-sim/lab/src/tune/parameters.rs",
    "host-sim/sim/src/run/passivity.rs",
    "proofs/src/accepted.rs",
    "proofs/src/set_laws.rs",
    "proofs/src/settings.rs",
    "tests/src/variants.rs",
];
/// Files that must contain the name of every law as users write it.
const IN_WORDS: [&str; 4] = [
    "docs/words.md",
    "docs/accuracy.md",
    "bindings/c/tests/emulated.rs",
    "bindings/c/tests/emulated/count.c",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

#[test]
fn every_law_stands_in_each_place() {
    let has = |place: &str, name: &str| {
        let text = std::fs::read_to_string(root().join(place)).expect(place);
        // One law's name can be the beginning of another law's name.
        let is_inside = |letter: char| letter.is_ascii_alphanumeric() || letter == '-';
        text.split(|letter| !is_inside(letter))
            .any(|word| word == name)
    };
    for law in LawKind::ALL {
        for place in IN_RUST {
            let name = format!("{law:?}");
            assert!(has(place, &name), "{place}: there is no `{name}`");
        }
        for place in IN_WORDS {
            let name = law.word();
            assert!(has(place, name), "{place}: there is no `{name}`");
        }
    }
}

/// The tests over all laws with all options run each law.
#[test]
fn every_law_is_a_variant() {
    let variants = touchstone_tests::variants::all(&Settings::default());
    for law in LawKind::ALL {
        assert!(variants.iter().any(|(_, it)| it.law == *law), "{law:?}");
    }
}
