//! Collects the results of fault injections and checks as lines of a table.

use std::collections::BTreeSet;

use touchstone_protocol::FaultCode;

use super::campaign::Outcome;
use super::list::{Expect, Injection};
use crate::bench::{Bench, MS, Setup};

/// The results of fault injections and checks on a device.
#[derive(Debug, Default)]
pub struct Tally {
    /// Name of the board and the encoder, used in reports of problems.
    pub device: String,
    /// Lines of the table of results.
    pub lines: Vec<String>,
    /// Descriptions of all deviations from expected results.
    pub wrong: Vec<String>,
    /// Number of fault injections so far.
    pub rows: usize,
    /// Simulated time of all devices together, s.
    pub simulated_s: f64,
    /// Fault codes that were latched as expected.
    pub latched: BTreeSet<FaultCode>,
}

impl Tally {
    /// A list of test results for this device, still empty.
    #[must_use]
    pub fn on(device: &str) -> Self {
        Self {
            device: device.to_owned(),
            ..Self::default()
        }
    }

    /// Adds a check's result as a line of the table; an error also counts as a problem.
    pub fn check(&mut self, what: &str, result: Result<String, String>) {
        let line = match result {
            Ok(text) => format!("{what}: {text}"),
            Err(error) => {
                self.wrong.push(format!("{}: {what}: {error}", self.device));
                format!("{what}: WRONG, {error}")
            }
        };
        // All checks together take minutes, so each result is printed at once to show the progress.
        eprintln!("{}: {line}", self.device);
        self.lines.push(line);
    }

    /// Adds the simulated time for which a device has run.
    pub fn ran(&mut self, bench: &Bench) {
        self.simulated_s += bench.now() as f64 / (1_000 * MS) as f64;
    }

    /// Adds the head of a table of injections: board, encoder, frequency of the watchdog's clock.
    pub fn head(&mut self, setup: &Setup) {
        self.lines.push(format!(
            "\n{}, the watchdog's clock at {} Hz",
            self.device, setup.lsi_hz
        ));
        self.lines.push(format!(
            "{:<42}{:<13}{:>6}{:>14}{:>12}  {}",
            "injection", "state", "at us", "off after us", "allowed us", "latched"
        ));
    }

    /// Adds an injection's result as a line of the table; a deviation also counts as a problem.
    pub fn row(&mut self, injection: &Injection, outcome: &Outcome) {
        self.rows += 1;
        let off = match (injection.expect, outcome.off_us) {
            (_, Some(us)) => format!("{us:.1}"),
            (Expect::GoesOn, None) => "goes on".into(),
            (_, None) => "were off".into(),
        };
        let limit = match injection.expect {
            Expect::Off(us, _) | Expect::OffAtLast(us, _) | Expect::Reset(us, _) => us.to_string(),
            Expect::GoesOn => String::new(),
        };
        let code = outcome
            .code
            .map_or(String::from("-"), |code| format!("{code:?}"));
        let mut line = format!(
            "{:<42}{:<13}{:>6}{off:>14}{limit:>12}  {code}",
            injection.name,
            injection.state(),
            injection.moment_us
        );
        match &outcome.wrong {
            None => self.latched.extend(outcome.code),
            Some(wrong) => {
                line += &format!("  WRONG: {wrong}");
                self.wrong
                    .push(format!("{}: {}: {wrong}", self.device, injection.title()));
            }
        }
        eprintln!("{}: {line}", self.device);
        self.lines.push(line);
    }
}
