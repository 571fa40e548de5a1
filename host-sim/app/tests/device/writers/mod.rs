//! Tests of every output of the program with every obstacle. Obstacles are an older file, a link, a full disk, another user's
//! folder, a killed process, two processes at once, and a device that does not answer.
//!
//! Afterwards the file at the path must be complete or unchanged, no other file may be left, and the error must be one line. This
//! command prints a table of all outputs and obstacles: `cargo test -p touchstone --test device writers -- --nocapture
//! --test-threads 1`.

mod disk;
mod killed;
mod older;
mod silent;

use crate::fake::Fake;
use crate::{Said, folder};
use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;
use touchstone_protocol::FaultCode;

/// An output: its name; its command with `OUT` in place of the file; whether the command needs a board; whether it replaces its own
/// earlier file without `--force`.
#[derive(Clone, Copy)]
struct Output(&'static str, &'static str, bool, bool);

const FILES: [Output; 10] = [
    Output(
        "run --junit",
        "run tap -q --expect active --expect passive --junit OUT",
        false,
        true,
    ),
    Output(
        "live --out",
        "live thesis-knob --no-open -q --out OUT",
        false,
        true,
    ),
    Output(
        "scorecard --programme",
        "scorecard thesis-knob --grip light -q --programme OUT",
        false,
        false,
    ),
    Output(
        "device run --csv",
        "device run plane --device simulated --fast --seconds 0.5 -q --csv OUT",
        false,
        false,
    ),
    Output(
        "device identify --out",
        "device identify --device simulated --fast --axis-s 2 -q --out OUT",
        false,
        false,
    ),
    Output(
        "device identify --scene",
        "device identify --device simulated --fast --axis-s 2 -q --scene OUT",
        false,
        false,
    ),
    Output(
        "monitor --csv",
        "monitor --seconds 0.3 -q --csv OUT",
        true,
        false,
    ),
    Output(
        "device survey --out",
        "device survey --seconds 0.3 -q --out OUT",
        false,
        false,
    ),
    Output("device ring --out", "device ring -q --out OUT", true, false),
    Output("config export", "config export OUT -q", true, false),
];

/// Outputs that are folders: reports, which the same code writes for all commands, and manual pages.
const FOLDERS: [Output; 6] = [
    Output("run --out", "run tap -q --out OUT", false, true),
    Output(
        "sweep --out",
        "sweep low-stiffness --no-certificate -q --x wall.k_desired_n_m_per_rad=1,2 --y timing.rate_hz=1000,2000 --out OUT",
        false,
        true,
    ),
    Output(
        "device run --out",
        "device run plane --device simulated --fast --seconds 0.5 -q --out OUT",
        false,
        true,
    ),
    Output(
        "scorecard --out",
        "scorecard thesis-knob --grip light --law spring -q --out OUT",
        false,
        true,
    ),
    Output(
        "boundary --out",
        "boundary press-hold --columns 2 --rows 2 --delays 0 --ticks 1000 -q --out OUT",
        false,
        true,
    ),
    Output("man", "man OUT", false, true),
];

/// Variants of the commands in [`SLOW`] that take seconds. `tune` ends with exit code 3, because a spring holds no wall on this
/// knob, and writes only because of `--force`.
fn short() -> [Output; 5] {
    static COMPARE: OnceLock<&str> = OnceLock::new();
    let compare = COMPARE.get_or_init(|| {
        let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("writers-flick.csv");
        let _ = std::fs::remove_file(&file);
        let counts = crate::compare::recorded(&file);
        let words = format!(
            "compare ../writers-flick.csv thesis-knob --set encoder.counts_per_rev={counts} -q --out OUT"
        );
        words.leak()
    });
    [
        Output(
            "tune --out",
            "tune thesis-knob --quick --law spring --force -q --out OUT",
            false,
            true,
        ),
        Output(
            "tune --report",
            "tune thesis-knob --quick --law spring --force -q --report OUT",
            false,
            true,
        ),
        Output("thesis --out", "thesis -q --out OUT", false, true),
        Output(
            "accuracy --out",
            "accuracy --quick -q --out OUT",
            false,
            true,
        ),
        Output("compare --out", compare, false, true),
    ]
}

/// Outputs that are files, including those of the short variants.
fn all_files() -> Vec<Output> {
    let [tune, ..] = short();
    FILES.into_iter().chain([tune]).collect()
}

/// Outputs that are folders, including those of the short variants.
fn all_folders() -> Vec<Output> {
    let [_, others @ ..] = short();
    FOLDERS.into_iter().chain(others).collect()
}

/// Outputs of commands that compute for long before they write. They must refuse an existing file of another command before they
/// compute.
const SLOW: [Output; 5] = [
    Output("tune --out", "tune thesis-knob -q --out OUT", false, true),
    Output(
        "tune --report",
        "tune thesis-knob -q --report OUT",
        false,
        true,
    ),
    Output("thesis --out", "thesis -q --out OUT", false, true),
    Output("accuracy --out", "accuracy -q --out OUT", false, true),
    Output(
        "compare --out",
        "compare none.csv thesis-knob -q --out OUT",
        false,
        true,
    ),
];

/// A command whose environment variables replace the omega.3's driver library by a mock.
fn with_mock(program: &str) -> Command {
    let mut command = Command::new(program);
    command.env("TOUCHSTONE_DHD", touchstone_mock_dhd::door::built());
    command
}

impl Output {
    fn words(&self, board: &Fake, out: &str) -> Vec<String> {
        let mut words: Vec<String> = self
            .1
            .split(' ')
            .map(|word| word.replace("OUT", out))
            .collect();
        if self.2 {
            words.extend(["--port".to_owned(), board.address.clone()]);
        }
        words
    }

    fn command(&self, here: &Path, board: &Fake) -> Command {
        let mut command = with_mock(env!("CARGO_BIN_EXE_touchstone"));
        command.args(self.words(board, "out")).current_dir(here);
        command
    }

    fn run(&self, here: &Path, board: &Fake) -> Said {
        self.command(here, board).output().unwrap().into()
    }

    /// Exit code of the command when it has written its output.
    fn good(&self) -> i32 {
        match self.0.starts_with("tune") {
            true => 3,
            false => 0,
        }
    }

    /// Checks that the command wrote its output.
    #[track_caller]
    fn succeeds(&self, said: &Said) {
        assert_eq!(said.code, Some(self.good()), "{}: {}", self.0, said.err);
    }

    /// Checks that the command failed with exit code 1 or 2 and one line of error that contains `part`.
    #[track_caller]
    fn fails(&self, said: &Said, part: &str) {
        assert!(
            matches!(said.code, Some(1 | 2)),
            "{}: {:?} {}{}",
            self.0,
            said.code,
            said.out,
            said.err
        );
        let errors: Vec<&str> = said
            .err
            .lines()
            .filter(|line| line.starts_with("error: "))
            .collect();
        assert!(
            errors.len() == 1 && errors[0].contains(part) && errors[0].contains("; "),
            "{}: {}",
            self.0,
            said.err
        );
    }
}

/// A board in a fault, so that the ring buffer of its last second has stopped and can be read.
fn board() -> Fake {
    let board = Fake::new();
    board.fault(FaultCode::OverSpeed, 61_000);
    board
}

/// Names of all files in the folder, including hidden ones, sorted.
fn names(folder: &Path) -> Vec<String> {
    let entry = |entry: std::io::Result<std::fs::DirEntry>| {
        entry.unwrap().file_name().into_string().unwrap()
    };
    let mut names: Vec<_> = std::fs::read_dir(folder).unwrap().map(entry).collect();
    names.sort();
    names
}

/// Prints a row of the table of outputs and obstacles, after its checks.
fn met(output: &Output, obstacle: &str, outcome: &str) {
    println!("{obstacle:<22}{:<24}{outcome}", output.0);
}

fn fresh(test: &str, output: &Output) -> std::path::PathBuf {
    folder(&format!(
        "writers-{test}-{}",
        output.0.replace([' ', '-'], "")
    ))
}
