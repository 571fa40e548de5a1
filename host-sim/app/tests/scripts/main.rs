//! Tests of the program in scripts and shells: limits on results, exit codes, JSON, `--quiet`, signals, and its own files as input.

mod answers;
mod cases;
mod demands;
mod feels;
mod fmus;
mod full_output;
mod inputs;
#[cfg(unix)]
mod interrupt;
mod motion;
mod own_firmware;
mod readers;
mod strict;
mod sweep;
mod tuning;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The output and exit code of the program.
pub struct Said {
    /// Exit code.
    pub code: Option<i32>,
    /// Standard output.
    pub out: String,
    /// Standard error.
    pub err: String,
}

impl From<Output> for Said {
    fn from(output: Output) -> Self {
        Said {
            code: output.status.code(),
            out: String::from_utf8(output.stdout).unwrap(),
            err: String::from_utf8(output.stderr).unwrap(),
        }
    }
}

impl Said {
    /// Checks that the program ended with this exit code; returns its output.
    #[track_caller]
    pub fn ended(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "{}{}", self.out, self.err);
        self
    }

    /// Parses the standard output as JSON.
    #[track_caller]
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.out).unwrap_or_else(|error| panic!("{error}: {}", self.out))
    }

    /// Checks that the program refused its input with one line of error that contains all `parts`.
    #[track_caller]
    pub fn refused(self, parts: &[&str]) {
        let Said { err, .. } = self.ended(2);
        assert_eq!(err.lines().count(), 1, "one line: {err}");
        assert!(err.starts_with("error: ") && err.contains("; "), "{err}");
        for part in parts {
            assert!(err.contains(part), "{err:?} does not name {part:?}");
        }
    }
}

/// An empty folder for one test.
pub fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("scripts-{test}"));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// The program's command in a folder, not yet run.
pub fn program(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_touchstone"));
    command.args(arguments).current_dir(folder);
    command
}

/// Runs the program in a folder.
pub fn run_in(folder: &Path, arguments: &[&str]) -> Said {
    run_words(folder, arguments)
}

/// Runs the program with arguments that need not be valid UTF-8.
pub fn run_words<S: AsRef<OsStr>>(folder: &Path, words: &[S]) -> Said {
    let mut command = program(folder, &[]);
    command.args(words).output().unwrap().into()
}

/// Runs a command that writes no files.
pub fn run(arguments: &[&str]) -> Said {
    run_in(Path::new(env!("CARGO_TARGET_TMPDIR")), arguments)
}

/// Names of the files in a folder, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}
