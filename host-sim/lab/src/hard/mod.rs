//! Hard cases: named situations in which simulators and control laws tend to fail, each with an independent source of the right
//! answer.
//!
//! A case measures each of its subjects (a plant, an integration method, a law in a number format) and has a bound for the value.
//! Known failures are listed by name, with the limit at which they begin. A known failure that stays within its bound counts as
//! unexpected.

mod closed;
mod feel;
mod integrators;
mod law;
mod parts;
mod plant;
mod random;
pub mod schema;
mod symmetry;
pub mod table;

use rayon::prelude::*;
use serde::Serialize;
use touchstone_sim::error::Result;

use touchstone_report::ProgramVersion;

/// Whether the hard cases run in their short or their long form.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Effort {
    /// Runs 10^9 ticks where the short form runs 10^7 or fewer.
    pub long: bool,
}

/// Result of one case for one subject.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// The tested plant, integration method, or control law with its number format.
    pub subject: String,
    /// The measured value, in the case's unit.
    pub value: f64,
    /// Largest value at which the subject passes.
    pub bound: f64,
    /// Reason why the value is known to exceed its bound; absent if the value must be within the bound.
    pub fails_because: Option<String>,
}

impl Finding {
    fn new(subject: impl Into<String>, value: f64, bound: f64) -> Self {
        Finding {
            subject: subject.into(),
            value,
            bound,
            fails_because: None,
        }
    }

    /// Marks the finding as a known failure.
    fn failing(self, because: impl Into<String>) -> Self {
        Finding {
            fails_because: Some(because.into()),
            ..self
        }
    }

    /// Whether the value is within its bound; false for NaN.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.value <= self.bound
    }

    /// Whether the result is as expected: within the bound, or beyond it for a known failure.
    #[must_use]
    pub fn is_as_expected(&self) -> bool {
        self.holds() == self.fails_because.is_none()
    }

    /// Measured value divided by its bound: 0 at best, 1 at the bound.
    #[must_use]
    pub fn used(&self) -> f64 {
        if self.value == 0.0 {
            0.0
        } else if self.value.is_nan() {
            f64::INFINITY
        } else {
            self.value / self.bound
        }
    }
}

/// A hard case: a named situation in which simulators or control laws tend to fail.
#[derive(Clone, Copy)]
pub struct Case {
    /// Name of the case.
    pub name: &'static str,
    /// The difficulty that the case tests.
    pub about: &'static str,
    /// Independent source of the right answer, in words.
    pub oracle: &'static str,
    /// Unit of the measured values and their bounds.
    pub unit: &'static str,
    /// Runs the case; returns one finding per subject.
    run: fn(Effort) -> Result<Vec<Finding>>,
}

/// Results of one hard case.
#[derive(Debug, Clone, Serialize)]
pub struct Outcome {
    /// Name of the case.
    pub name: &'static str,
    /// The difficulty that the case tests.
    pub about: &'static str,
    /// Independent source of the right answer, in words.
    pub oracle: &'static str,
    /// Unit of the measured values and their bounds.
    pub unit: &'static str,
    /// Whether every finding is as expected, known failures included.
    pub passed: bool,
    /// Findings for every subject (plant, integration method, or law in a number format).
    pub findings: Vec<Finding>,
    /// Time that the case took, s.
    pub seconds: f64,
}

impl Outcome {
    /// The result with the largest ratio of value to bound, known failures left out.
    #[must_use]
    pub fn worst(&self) -> Option<&Finding> {
        self.findings
            .iter()
            .filter(|finding| finding.fails_because.is_none())
            .max_by(|a, b| a.used().total_cmp(&b.used()))
    }

    /// Unexpected results: values beyond their bounds, and known failures within theirs.
    pub fn surprises(&self) -> impl Iterator<Item = &Finding> {
        self.findings
            .iter()
            .filter(|finding| !finding.is_as_expected())
    }
}

/// Results of all hard cases.
#[derive(Debug, Clone, Serialize)]
pub struct Hard {
    /// Version of the results' format.
    pub schema_version: u32,
    /// Version of the program.
    pub program: ProgramVersion,
    /// Whether the long form with 10^9 ticks ran.
    pub long: bool,
    /// Whether every case passed.
    pub passed: bool,
    /// Results of every case.
    pub cases: Vec<Outcome>,
}

/// All hard cases, in the order of the table.
#[must_use]
pub fn cases() -> Vec<Case> {
    [
        plant::CASES,
        symmetry::CASES,
        integrators::CASES,
        law::CASES,
        parts::CASES,
        feel::CASES,
        closed::CASES,
    ]
    .concat()
}

/// Runs the cases in parallel. `on_case` is called when a case ends.
///
/// # Errors
/// A shipped scene cannot be run.
pub fn run(
    cases: &[Case],
    effort: Effort,
    program: ProgramVersion,
    on_case: impl Fn(&Outcome) + Sync,
) -> Result<Hard> {
    let cases = cases
        .par_iter()
        .map(|case| {
            let start = std::time::Instant::now();
            let findings = (case.run)(effort)?;
            let outcome = Outcome {
                name: case.name,
                about: case.about,
                oracle: case.oracle,
                unit: case.unit,
                // A case without findings has not passed.
                passed: !findings.is_empty() && findings.iter().all(Finding::is_as_expected),
                findings,
                seconds: start.elapsed().as_secs_f64(),
            };
            on_case(&outcome);
            Ok(outcome)
        })
        .collect::<Result<Vec<_>>>()?;
    Ok(Hard {
        schema_version: 1,
        program,
        long: effort.long,
        passed: cases.iter().all(|case| case.passed),
        cases,
    })
}

#[cfg(test)]
mod tests;
