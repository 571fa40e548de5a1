//! Checks that every board is named in each file where the compiler does not report a missing board.

use std::path::{Path, PathBuf};
use touchstone_protocol::Board;

/// Files that must contain the name of every board.
const PLACES: [&str; 6] = [
    "firmware/Cargo.toml",
    "firmware/src/lib.rs",
    "emulator/src/board.rs",
    "emulator/src/fil/jobs.rs",
    "emulator/registers/pins.tsv",
    "emulator/registers/registers.tsv",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

#[test]
fn every_board_stands_in_each_place() {
    for place in PLACES {
        let text = std::fs::read_to_string(root().join(place)).expect(place);
        // The name of a board's function has underscores.
        let text = text.replace('_', "-");
        // One board's name can be the beginning of another board's name.
        let is_inside = |letter: char| letter.is_ascii_alphanumeric() || letter == '-';
        let words: Vec<&str> = text.split(|letter| !is_inside(letter)).collect();
        for board in Board::ALL {
            let name = board.name();
            assert!(words.contains(&name), "{place}: there is no `{name}`");
        }
    }
}

#[test]
fn every_board_has_a_program_and_no_program_is_without_a_board() {
    let folder = root().join("firmware/src/bin");
    let files = std::fs::read_dir(folder).expect("firmware/src/bin");
    let mut programs: Vec<String> = files
        .map(|file| file.expect("firmware/src/bin").path())
        .filter_map(|file| Some(file.file_stem()?.to_str()?.replace('_', "-")))
        .collect();
    programs.sort();
    let mut boards: Vec<&str> = Board::ALL.iter().map(|board| board.name()).collect();
    boards.sort_unstable();
    assert_eq!(programs, boards);
}
