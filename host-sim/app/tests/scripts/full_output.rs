//! Tests with a standard output that accepts no more data: a full disk, imitated by `/dev/full`, and a pipe whose reader has closed
//! it.

use crate::{Said, folder};
use std::path::Path;
use std::process::{Command, Stdio};

/// Commands of every kind that print their result.
const COMMANDS: [&str; 18] = [
    "--help",
    "--version",
    "run --help",
    "help config",
    "scenes",
    "scenes --json-schema",
    "feels --json",
    "certify press-hold --grips --no-margins",
    "certify press-hold --grips --no-margins --json",
    "run tap",
    "run tap --json",
    "run tap --print",
    "run delta-ball",
    "plan tap",
    "doctor",
    "doctor --json",
    "completions bash",
    "man",
];

fn command(here: &Path, words: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_touchstone"));
    command.args(words.split(' ')).current_dir(here);
    command
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_said_in_a_line() {
    let here = folder("full-output");
    for words in COMMANDS {
        let full = std::fs::File::options().write(true).open("/dev/full");
        let ended = command(&here, words).stdout(full.unwrap()).output();
        let said = Said::from(ended.unwrap());
        assert_eq!(said.code, Some(2), "{words}: {}", said.err);
        assert!(
            said.err.lines().count() == 1
                && said
                    .err
                    .starts_with("error: standard output: No space left"),
            "{words}: {}",
            said.err
        );
    }
    assert!(crate::names(&here).is_empty());
}

#[test]
fn a_reader_that_goes_is_no_error() {
    let here = folder("closed-output");
    for words in COMMANDS {
        let mut child = command(&here, words)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let said = Said::from(child.wait_with_output().unwrap());
        assert_eq!(
            (said.code, said.err.as_str()),
            (Some(0), ""),
            "{words}: {}",
            said.out
        );
    }
}
