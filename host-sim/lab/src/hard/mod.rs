//! Hard cases, by name: what breaks simulators and control laws, each with a source of the right answer.
//!
//! A case measures each of its subjects (a plant, an integrator, a law in a number format) and has a bound for the
//! value. A known failure is expected by name, with its boundary computed: it would be a surprise if it held.

mod closed;
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

use crate::report::ProgramVersion;

/// How much is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Effort {
    /// 10^9 ticks where the sample does 10^7 or fewer.
    pub long: bool,
}

/// The finding for one subject.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// Plant, integrator, or law with its number format.
    pub subject: String,
    /// The measured value, in the case's unit.
    pub value: f64,
    /// Largest allowed value.
    pub bound: f64,
    /// Why it is known to be more; absent: it must hold.
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

    /// The finding as a known failure.
    fn failing(self, because: impl Into<String>) -> Self {
        Finding {
            fails_because: Some(because.into()),
            ..self
        }
    }

    /// Whether the value is within its bound; a value that is no number is not.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.value <= self.bound
    }

    /// Whether it came out as it must.
    #[must_use]
    pub fn is_as_expected(&self) -> bool {
        self.holds() == self.fails_because.is_none()
    }

    /// Share of the bound that is used: 0 at best, 1 at the bound.
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

/// A case.
#[derive(Clone, Copy)]
pub struct Case {
    /// Name of the case.
    pub name: &'static str,
    /// The difficulty that the case tests.
    pub about: &'static str,
    /// What knows the answer.
    pub oracle: &'static str,
    /// Unit of values and bounds.
    pub unit: &'static str,
    /// Finds out.
    run: fn(Effort) -> Result<Vec<Finding>>,
}

/// One case's outcome.
#[derive(Debug, Clone, Serialize)]
pub struct Outcome {
    /// Name of the case.
    pub name: &'static str,
    /// The difficulty that the case tests.
    pub about: &'static str,
    /// What knows the answer.
    pub oracle: &'static str,
    /// Unit of values and bounds.
    pub unit: &'static str,
    /// Whether everything came out as it must, failures that are expected included.
    pub passed: bool,
    /// Every subject.
    pub findings: Vec<Finding>,
    /// Time it took, s.
    pub seconds: f64,
}

impl Outcome {
    /// The finding that uses most of its bound, of those that must hold.
    #[must_use]
    pub fn worst(&self) -> Option<&Finding> {
        self.findings
            .iter()
            .filter(|finding| finding.fails_because.is_none())
            .max_by(|a, b| a.used().total_cmp(&b.used()))
    }

    /// What did not come out as it must.
    pub fn surprises(&self) -> impl Iterator<Item = &Finding> {
        self.findings
            .iter()
            .filter(|finding| !finding.is_as_expected())
    }
}

/// Everything that was found.
#[derive(Debug, Clone, Serialize)]
pub struct Hard {
    /// Version of this layout.
    pub schema_version: u32,
    /// The program.
    pub program: ProgramVersion,
    /// Whether the long form ran.
    pub long: bool,
    /// Whether every case passed.
    pub passed: bool,
    /// Every case.
    pub cases: Vec<Outcome>,
}

/// All cases, in the order of the table.
#[must_use]
pub fn cases() -> Vec<Case> {
    [
        plant::CASES,
        symmetry::CASES,
        integrators::CASES,
        law::CASES,
        parts::CASES,
        closed::CASES,
    ]
    .concat()
}

/// Runs cases side by side. `on_case` is called as each ends.
///
/// # Errors
/// A shipped scene that cannot be run.
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
                // A case that looked at nothing has shown nothing.
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
