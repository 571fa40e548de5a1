//! `cargo xtask unit`: runs all tests of all crates. Further arguments go to `cargo test`, as in `cargo xtask unit -- observer`.
//!
//! With `--quick`, the documentation's examples and the tests of [`SLOW`] are left out.

use std::fmt::Write;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

use crate::outcome::Outcome;
use crate::shell;
use crate::step::Gates;

/// Option with which all gates but `cargo xtask test --full` call this step.
const QUICK: &str = "--quick";
pub const GATES: Gates = Gates::part(
    &[QUICK],
    "documentation examples; instructions of an absent effect, for which the simulator is built optimised",
);

/// Tests that a quick run leaves out, each given by a text that occurs in no other test's name. The one test here builds the
/// simulator with all optimisations, which takes minutes, and counts its instructions.
const SLOW: [&str; 1] = ["what_a_scene_does_not_name_costs_no_instruction"];

/// Number of the slowest test binaries that are listed with their times.
const SLOWEST: usize = 10;
/// Environment variable with the number of tests that a test binary runs at the same time.
const THREADS: &str = "RUST_TEST_THREADS";

static HAS_COMPILED: AtomicBool = AtomicBool::new(false);
static ALL_PASSED: AtomicBool = AtomicBool::new(false);

/// Whether all tests of all crates have passed since this program started, so that a later step need not repeat some.
pub fn all_passed() -> bool {
    ALL_PASSED.load(Relaxed)
}

/// Whether all tests of all crates were compiled and passed, but for those of a quick run, since this program started.
pub fn has_compiled() -> bool {
    HAS_COMPILED.load(Relaxed)
}

/// Test results read from the output of `cargo test`.
#[derive(Debug, Default)]
struct Seen {
    passed: u64,
    ignored: u64,
    failed: Vec<String>,
    /// Name of the test binary that is running.
    binary: String,
    /// Running time in seconds and name of each test binary that has ended.
    times: Vec<(f64, String)>,
}

impl Seen {
    fn line(&mut self, line: &str) {
        if let Some(name) = binary(line) {
            self.binary = name;
        } else if let Some((passed, ignored)) = counts(line) {
            self.passed += passed;
            self.ignored += ignored;
            let seconds = line.rsplit("finished in ").next();
            let seconds = seconds.and_then(|time| time.trim_end().strip_suffix('s')?.parse().ok());
            self.times
                .push((seconds.unwrap_or(0.0), self.binary.clone()));
        } else {
            self.failed.extend(failed_test(line).map(str::to_owned));
        }
    }

    /// A text that lists the slowest test binaries.
    fn slowest(&mut self) -> String {
        self.times.sort_by(|one, other| other.0.total_cmp(&one.0));
        let all: f64 = self.times.iter().map(|(seconds, _)| seconds).sum();
        let shown = self.times.len().min(SLOWEST);
        let mut text = format!(
            "{} test binaries ran for {all:.1} s; the slowest:\n",
            self.times.len()
        );
        for (seconds, name) in &self.times[..shown] {
            let _ = writeln!(text, "{seconds:>8.1} s  {name}");
        }
        text
    }
}

/// The name of the test binary in a line that cargo prints, such as `Running tests/talk.rs (target/debug/deps/talk-1bb2)`.
fn binary(line: &str) -> Option<String> {
    let line = line.trim_start();
    if let Some(krate) = line.strip_prefix("Doc-tests ") {
        return Some(format!("{krate}, documentation"));
    }
    let (source, file) = line.strip_prefix("Running ")?.rsplit_once(" (")?;
    let file = file.strip_suffix(')')?.rsplit(['/', '\\']).next()?;
    let name = file.rsplit_once('-').map_or(file, |(name, _)| name);
    Some(format!("{name} ({source})"))
}

/// Numbers of passed and ignored tests in a line such as `test result: ok. 36 passed; 0 failed; 1 ignored; …`.
fn counts(line: &str) -> Option<(u64, u64)> {
    let rest = line.strip_prefix("test result: ")?;
    let before = |word: &str| -> Option<u64> {
        let head = rest.split(word).next()?;
        head.split_whitespace().last()?.parse().ok()
    };
    Some((before(" passed")?, before(" ignored")?))
}

/// Text with the first few names of failed tests and the number of the others. The test output above lists all of them.
fn first_of(names: &[String]) -> String {
    const FEW: usize = 4;
    let few = names[..names.len().min(FEW)].join(", ");
    match names.len().saturating_sub(FEW) {
        0 => few,
        more => format!("{few} and {more} more"),
    }
}

/// The test's name in a line such as `test observer::exact ... FAILED`.
fn failed_test(line: &str) -> Option<&str> {
    line.strip_prefix("test ")?.strip_suffix(" ... FAILED")
}

/// The arguments that are passed to `cargo test`.
fn words(args: &[String]) -> Vec<&str> {
    if args != [QUICK] {
        return args.iter().map(String::as_str).collect();
    }
    let mut words = vec!["--lib", "--bins", "--tests", "--"];
    for test in SLOW {
        words.extend(["--skip", test]);
    }
    words
}

pub fn run(args: &[String]) -> Outcome {
    let words = words(args);
    let (mut seen, mut broken) = (Seen::default(), None);
    // Tests the control crate also alone: in the workspace it is built with the feature `float`, which firmware leaves out.
    let packages: [&[&str]; 2] = [&["--workspace"], &["--package", "touchstone-control"]];
    for packages in packages {
        let mut command = shell::cargo_locked("test");
        // The tests of devices wait most of the time, for answers and deadlines.
        if std::env::var_os(THREADS).is_none() {
            let cores = std::thread::available_parallelism().map_or(1, usize::from);
            command.env(THREADS, (3 * cores).to_string());
        }
        // Does not stop at the first failure, so that one failure hides no other.
        command.args(packages).arg("--no-fail-fast").args(&words);
        let outcome = shell::run_reading_all(&mut command, |line| seen.line(line));
        if outcome.is_failure() {
            broken = broken.or(Some(outcome));
        }
    }
    HAS_COMPILED.store(broken.is_none(), Relaxed);
    println!("\n{}", seen.slowest());
    let Seen {
        passed,
        ignored,
        failed,
        ..
    } = seen;
    let all = passed + failed.len() as u64;
    ALL_PASSED.store(args.is_empty() && broken.is_none(), Relaxed);
    match (broken, ignored) {
        (Some(_), _) if !failed.is_empty() => Outcome::Failed(format!(
            "{} of {all} tests: {}",
            failed.len(),
            first_of(&failed)
        )),
        (Some(broken), _) => broken,
        (None, 0) => Outcome::Ok(format!("{passed} tests")),
        (None, _) => Outcome::Ok(format!("{passed} tests, {ignored} ignored")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_summary_line_is_counted_and_no_other() {
        let line = "test result: ok. 36 passed; 0 failed; 2 ignored; 0 measured; 0 filtered out";
        assert_eq!(counts(line), Some((36, 2)));
        assert_eq!(counts("test passed::ignored ... ok"), None);
        assert_eq!(counts(""), None);
    }

    #[test]
    fn a_failed_test_is_named() {
        let line = "test observer::exact ... FAILED";
        assert_eq!(failed_test(line), Some("observer::exact"));
        assert_eq!(failed_test("test observer::exact ... ok"), None);
    }

    #[test]
    fn the_slowest_binaries_come_first() {
        let mut seen = Seen::default();
        for line in [
            "     Running unittests src/lib.rs (target/debug/deps/touchstone_control-12ab)",
            "test result: ok. 3 passed; 0 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.96s",
            "     Running tests/talk.rs (target/debug/deps/talk-34cd)",
            "test decay ... FAILED",
            "test result: FAILED. 1 passed; 1 failed; 0 ignored; 0 measured; 0 filtered out; finished in 5.10s",
            "   Doc-tests touchstone_drive",
            "test result: ok. 1 passed; 0 failed; 1 ignored; 0 measured; 0 filtered out; finished in 0.50s",
        ] {
            seen.line(line);
        }
        assert_eq!((seen.passed, seen.ignored), (5, 1));
        assert_eq!(seen.failed, ["decay"]);
        assert_eq!(
            seen.slowest(),
            "3 test binaries ran for 6.6 s; the slowest:\n     5.1 s  talk (tests/talk.rs)\n\
             \x20    1.0 s  touchstone_control (unittests src/lib.rs)\n     0.5 s  touchstone_drive, documentation\n"
        );
    }

    #[test]
    fn what_a_quick_run_leaves_out_is_in_the_sources_once() {
        let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/tests/all");
        let mut texts = String::new();
        for entry in std::fs::read_dir(folder).expect("the tests") {
            texts += &std::fs::read_to_string(entry.expect("readable").path()).unwrap_or_default();
        }
        for test in SLOW {
            assert_eq!(texts.matches(&format!("fn {test}(")).count(), 1, "{test}");
        }
        assert!(words(&[QUICK.into()]).ends_with(&["--skip", SLOW[SLOW.len() - 1]]));
    }
}
