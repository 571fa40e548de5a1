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

pub fn run(args: &[String]) -> Outcome {
    let (mut passed, mut ignored) = (0, 0);
    // The control crate once more by itself: in the workspace it is built with `float`, which firmware leaves out.
    let packages: [&[&str]; 2] = [&["--workspace"], &["--package", "touchstone-control"]];
    for packages in packages {
        let mut command = shell::cargo_locked("test");
        command.args(packages).args(args);
        let outcome = shell::run_reading(&mut command, |line| {
            if let Some(more) = counts(line) {
                passed += more.0;
                ignored += more.1;
            }
        });
        if outcome.is_failure() {
            return outcome;
        }
    }
    let note = match ignored {
        0 => format!("{passed} tests"),
        _ => format!("{passed} tests, {ignored} ignored"),
    };
    Outcome::Ok(note)
}

#[cfg(test)]
mod tests {
    use super::counts;

    #[test]
    fn a_summary_line_is_counted_and_no_other() {
        let line = "test result: ok. 36 passed; 0 failed; 2 ignored; 0 measured; 0 filtered out";
        assert_eq!(counts(line), Some((36, 2)));
        assert_eq!(counts("test passed::ignored ... ok"), None);
        assert_eq!(counts(""), None);
    }
}
