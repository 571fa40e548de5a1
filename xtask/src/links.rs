//! `cargo xtask links [SEEDS]`: tests faults of the link between program and device with many more seeds than the ordinary tests.
//! Each seed chooses a fault (lost, damaged or delayed frames, one direction blocked, connection cut), its time and its strength.

use crate::outcome::Outcome;
use crate::shell;

const USAGE: &str = "cargo xtask links [SEEDS]";

/// A program, the part of its test's name that no other test has, and the number of seeds that takes about a minute on two busy
/// cores. The ordinary tests use ten. `links 1000`, with 1,000 for each program, takes some twenty minutes.
const PROGRAMS: [(&str, &str, &str); 4] = [
    ("monitor", "link_faults::a_monitor_", "1000"),
    ("live", "link_faults::a_page_s_program_", "100"),
    ("setup", "link_faults::a_setup_", "100"),
    (
        "device run",
        "link_faults::a_run_on_a_haptic_device_",
        "250",
    ),
];

pub fn run(args: &[String]) -> Outcome {
    let asked = match args {
        [] => None,
        [seeds] if seeds.parse::<u32>().is_ok_and(|seeds| seeds > 0) => Some(seeds.as_str()),
        _ => return Outcome::Usage(USAGE.into()),
    };
    if !cfg!(unix) {
        return Outcome::NotRun("the tests need Unix signals".into());
    }
    let mut done = Vec::new();
    for (program, name, seeds) in PROGRAMS {
        let seeds = asked.unwrap_or(seeds);
        let mut passed = None;
        let mut test = shell::cargo_locked("test");
        test.args(["--workspace", "--test", "device", "--", name, "--nocapture"])
            .env("TOUCHSTONE_LINK_FAULTS", seeds);
        match shell::run_reading(&mut test, |line| passed = passed.or(passed_in(line))) {
            Outcome::Ok(_) if passed == Some(1) => done.push(format!("{program} {seeds}")),
            // The test was renamed, and the name above no longer fits.
            Outcome::Ok(_) => {
                return Outcome::Failed(format!("no single test has {name} in its name"));
            }
            failed => return failed,
        }
    }
    Outcome::Ok(format!("seeds: {}", done.join(", ")))
}

/// Number of passed tests in a line such as `test result: ok. 4 passed; 0 failed; …`.
fn passed_in(line: &str) -> Option<usize> {
    let rest = line.strip_prefix("test result: ok. ")?;
    rest.split(' ').next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passed_tests_are_read_from_the_summary_only() {
        let line = "test result: ok. 4 passed; 0 failed; 0 ignored; 0 measured; 90 filtered out";
        assert_eq!(passed_in(line), Some(4));
        assert_eq!(passed_in("test link_faults::a_monitor ... ok"), None);
        assert_eq!(passed_in("test result: FAILED. 3 passed; 1 failed"), None);
    }

    #[test]
    fn what_is_no_number_of_seeds_is_refused() {
        for words in [&["0"][..], &["-3"], &["many"], &["1", "2"]] {
            let words: Vec<_> = words.iter().map(|word| (*word).to_owned()).collect();
            assert_eq!(run(&words).word(), "usage", "{words:?}");
        }
    }

    /// Checks that each program's test is in the sources once.
    #[test]
    fn each_test_exists_once() {
        let file = shell::root().join("host-sim/app/tests/device/link_faults.rs");
        let text = std::fs::read_to_string(file).expect("the tests");
        for (_, name, _) in PROGRAMS {
            let name = name.trim_start_matches("link_faults::");
            assert_eq!(text.matches(&format!("fn {name}")).count(), 1, "{name}");
        }
        assert_eq!(text.matches("#[test]").count(), PROGRAMS.len());
    }
}
