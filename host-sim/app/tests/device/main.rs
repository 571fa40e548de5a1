//! Tests of the program against an imitated device. Behind a TCP socket or a pseudo terminal, the firmware's own protocol code
//! answers.

mod board_page;
#[cfg(target_os = "linux")]
mod bridge;
mod cogging;
mod compare;
mod config;
#[cfg(unix)]
mod demo;
mod doctor;
mod eccentricity;
mod environment;
#[cfg(unix)]
mod events;
mod failures;
mod fake;
mod flash;
#[cfg(unix)]
#[path = "../../../device/tests/haply_mock/mod.rs"]
#[expect(
    dead_code,
    reason = "its own faults are played by the device crate's own tests"
)]
mod haply_mock;
mod json;
mod lifecycle;
#[cfg(unix)]
mod link_faults;
#[cfg(target_os = "linux")]
mod midi;
mod monitor;
#[cfg(unix)]
mod sent_feel;
mod setup;
#[cfg(target_os = "linux")]
mod setup_outputs;
#[cfg(unix)]
mod silence;
mod spun;
mod start;
mod unwatched;
#[cfg(unix)]
mod websocket;
#[cfg(target_os = "linux")]
mod writers;

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
    /// Checks that the program succeeded; returns its standard output.
    #[track_caller]
    pub fn done(self) -> String {
        assert_eq!(
            (self.code, self.err.as_str()),
            (Some(0), ""),
            "{}",
            self.out
        );
        self.out
    }

    /// Checks that the program ended with this exit code and one line of error that contains all `parts`.
    #[track_caller]
    pub fn failed(self, code: i32, parts: &[&str]) {
        let Said { err, .. } = &self;
        assert_eq!(self.code, Some(code), "{err}");
        assert_eq!(err.lines().count(), 1, "one line: {err}");
        assert!(
            err.starts_with("error: ") && err.contains("; "),
            "problem; fix: {err}"
        );
        for part in parts {
            assert!(err.contains(part), "{err:?} does not name {part:?}");
        }
    }
}

/// The program's command with these arguments, not yet run.
pub fn program(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_touchstone"));
    command.args(arguments);
    command
}

/// Runs the program with these arguments.
pub fn run(arguments: &[&str]) -> Said {
    program(arguments).output().unwrap().into()
}

/// An empty folder for one test.
pub fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("device-{test}"));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Writes an executable shell script.
#[cfg(unix)]
pub fn script(folder: &Path, name: &str, text: &str) {
    use std::os::unix::fs::PermissionsExt;
    let path = folder.join(name);
    std::fs::write(&path, format!("#!/bin/sh\n{text}\n")).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
}
