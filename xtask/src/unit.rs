//! `cargo xtask unit`: all tests of all crates. What follows goes to `cargo test`: `cargo xtask unit -- observer`.

use crate::outcome::Outcome;
use crate::shell;

/// Passed and ignored tests in a line such as `test result: ok. 36 passed; 0 failed; 1 ignored; …`.
fn counts(line: &str) -> Option<(u64, u64)> {
    let rest = line.strip_prefix("test result: ")?;
    let before = |word: &str| -> Option<u64> {
        let head = rest.split(word).next()?;
        head.split_whitespace().last()?.parse().ok()
    };
    Some((before(" passed")?, before(" ignored")?))
}

/// The first few names, and how many more there are; all of them stand in the output above.
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

pub fn run(args: &[String]) -> Outcome {
    let (mut passed, mut ignored) = (0, 0);
    let (mut failed, mut broken) = (Vec::new(), None);
    // The control crate once more by itself: in the workspace it is built with `float`, which firmware leaves out.
    let packages: [&[&str]; 2] = [&["--workspace"], &["--package", "touchstone-control"]];
    for packages in packages {
        let mut command = shell::cargo_locked("test");
        // To the end, so that one failure hides no other.
        command.args(packages).arg("--no-fail-fast").args(args);
        let outcome = shell::run_reading(&mut command, |line| {
            if let Some(more) = counts(line) {
                passed += more.0;
                ignored += more.1;
            }
            failed.extend(failed_test(line).map(str::to_owned));
        });
        if outcome.is_failure() {
            broken = broken.or(Some(outcome));
        }
    }
    let all = passed + failed.len() as u64;
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
    use super::{counts, failed_test};

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
}
