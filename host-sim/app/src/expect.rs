//! Demands on a simulation run, for scripts: its verdict, depth, stiffness and energy. The results are an exit code, lines of text,
//! and a JUnit file.

use super::check::{Check, Subject};
use super::out::{json, note};
use super::whole::{Named, is_of_same_command};
use super::{baseline, number};
use clap::builder::{PossibleValue, PossibleValuesParser};
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::harmless::one_line;
use touchstone_sim::output;
use touchstone_sim::run::record::Summary;
use touchstone_sim::run::verdict::{NO_CONTACT, NOT_JUDGED, WORDS};
use touchstone_sim::scene::list;

/// Exit code if a run was simulated to its end but does not meet a demand.
pub const NOT_MET: u8 = 3;

/// Options that each make a demand on the simulation runs.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(next_help_heading = "Demands on the run (exit code 3 if one is not met)")]
pub struct Expectations {
    /// Demands this verdict; given several times, one of these verdicts.
    #[arg(long, value_name = "VERDICT", value_parser = verdicts())]
    expect: Vec<String>,
    /// Largest allowed depth of the device in the wall, true penetration in rad.
    #[arg(long, value_name = "RAD", allow_negative_numbers = true, value_parser = number::not_negative("in rad"))]
    max_penetration: Option<f64>,
    /// Smallest allowed stiffness that the wall renders at the end of the hold, N·m/rad.
    #[arg(long, value_name = "N_M_PER_RAD", allow_negative_numbers = true, value_parser = number::not_negative("in N·m/rad"))]
    min_stiffness: Option<f64>,
    /// Most energy that the device may give to the hand beyond what it took from the hand, at any time, J.
    #[arg(long, value_name = "J", allow_negative_numbers = true, value_parser = number::not_negative("in J"))]
    max_energy_out: Option<f64>,
    /// Results file of earlier runs: demands the same verdict for each run, and no measure worse by more than the margin.
    #[arg(long, value_name = "FILE")]
    baseline: Option<PathBuf>,
    /// Fraction of its value by which a measure may be worse than in the baseline.
    #[arg(long, value_name = "SHARE", default_value_t = 0.01, requires = "baseline", allow_negative_numbers = true, value_parser = number::not_negative("a share, 0.01 for 1 %"))]
    margin: f64,
    /// Writes demands and results as a JUnit file, one test for each demand; replaces only an earlier JUnit file of this program.
    #[arg(long, value_name = "FILE")]
    junit: Option<PathBuf>,
}

impl Expectations {
    /// The name of the first option given by the user that makes or reports a demand; `None` without any.
    pub fn first_given(&self) -> Option<&'static str> {
        // Without `..`: a new option that is missing here does not compile. The margin alone demands nothing.
        let Self {
            expect,
            max_penetration,
            min_stiffness,
            max_energy_out,
            baseline,
            margin: _,
            junit,
        } = self;
        let given = [
            ("--expect", !expect.is_empty()),
            ("--max-penetration", max_penetration.is_some()),
            ("--min-stiffness", min_stiffness.is_some()),
            ("--max-energy-out", max_energy_out.is_some()),
            ("--baseline", baseline.is_some()),
            ("--junit", junit.is_some()),
        ];
        let first = given.into_iter().find(|(_, given)| *given);
        first.map(|(option, _)| option)
    }

    /// The name of the first option given by the user that applies only to runs in one axis; `None` without any.
    pub fn first_of_one_axis(&self) -> Option<&'static str> {
        let given = [
            ("--max-penetration", self.max_penetration.is_some()),
            ("--min-stiffness", self.min_stiffness.is_some()),
            ("--baseline", self.baseline.is_some()),
        ];
        let first = given.into_iter().find(|(_, given)| *given);
        first.map(|(option, _)| option)
    }
}

/// The possible verdicts on a run with their meanings, for the help and for completions.
fn verdicts() -> PossibleValuesParser {
    PossibleValuesParser::new(WORDS.map(|(name, meaning)| PossibleValue::new(name).help(meaning)))
}

/// Results of all demands on all runs, and where to write them.
#[derive(Debug, Clone, Default)]
pub struct Checked {
    checks: Vec<Check>,
    junit: Option<PathBuf>,
}

impl Expectations {
    /// Checks the options before anything is simulated. Errors: a JUnit file is requested without any demand, or cannot be written.
    pub fn validate(&self, strict: bool) -> Result<()> {
        let asked = strict
            || !self.expect.is_empty()
            || self.max_penetration.is_some()
            || self.min_stiffness.is_some()
            || self.max_energy_out.is_some()
            || self.baseline.is_some();
        if self.junit.is_some() && !asked {
            return Err(Error::Option {
                option: "--junit".to_owned(),
                problem: "there is no demand on the run, so there is no test to write".to_owned(),
                fix: "add --expect, --max-penetration, --min-stiffness, --max-energy-out, --baseline or --strict-passive".to_owned(),
            });
        }
        match &self.junit {
            Some(file) => junit_file(file).check(),
            None => Ok(()),
        }
    }

    /// Checks runs against the demands. `strict`: also demands that in no run the hand gets more energy than it put in.
    pub fn check(&self, strict: bool, runs: impl Iterator<Item = Subject>) -> Checked {
        Checked {
            checks: runs.flat_map(|run| self.on(&run, strict)).collect(),
            junit: self.junit.clone(),
        }
    }

    /// Compares runs with those of the baseline, if the user gave `--baseline`.
    ///
    /// # Errors
    /// The baseline cannot be read.
    pub fn compare<'a>(
        &self,
        checked: &mut Checked,
        runs: impl Iterator<Item = &'a Summary>,
    ) -> Result<()> {
        if let Some(file) = &self.baseline {
            let before = baseline::read(file)?;
            let found = runs.flat_map(|run| baseline::on(run, &before, self.margin));
            checked.checks.extend(found);
        }
        Ok(())
    }

    fn on(&self, run: &Subject, strict: bool) -> Vec<Check> {
        let mut checks = Vec::new();
        // A run without contact says nothing about the wall: it meets no demand, unless no contact is the demanded verdict.
        let touched =
            run.verdict != NO_CONTACT || self.expect.iter().any(|word| word == NO_CONTACT);
        let mut add = |option, met: bool, wanted: String, came: String| {
            let (met, came) = match touched || option == "--expect" {
                true => (met, came),
                false => (
                    false,
                    format!("{NO_CONTACT}, which shows nothing of the wall"),
                ),
            };
            checks.push(Check {
                run: run.name.clone(),
                option,
                wanted,
                came,
                met,
                not_judged: run.not_judged.clone(),
            });
        };
        if !self.expect.is_empty() {
            let words: Vec<&str> = self.expect.iter().map(String::as_str).collect();
            let came = run.verdict;
            add(
                "--expect",
                words.contains(&came),
                list(&words),
                run.verdict_and_why(),
            );
        }
        let out = run.energy_out;
        // NaN fails each of these comparisons, so that it meets no demand.
        if let (Some(most), Some(came)) = (self.max_penetration, run.penetration_max) {
            add(
                "--max-penetration",
                came <= most,
                format!("at most {most} rad"),
                format!("{came:.6} rad"),
            );
        }
        if let Some(least) = self.min_stiffness {
            add(
                "--min-stiffness",
                run.k_displayed.is_some_and(|came| came >= least),
                format!("at least {least} N·m/rad"),
                run.k_displayed.map_or_else(
                    || "none: the knob did not stay in the wall during the hold".to_owned(),
                    |came| format!("{came:.6} N·m/rad"),
                ),
            );
        }
        if let Some(most) = self.max_energy_out {
            add(
                "--max-energy-out",
                out <= most,
                format!("at most {most} J"),
                joules(out),
            );
        }
        if strict {
            add(
                "--strict-passive",
                out <= 0.0,
                "that the hand gets out no more energy than it put in".to_owned(),
                joules(out),
            );
        }
        checks
    }
}

/// An energy in joules, with the exponent that small energies need.
fn joules(energy_j: f64) -> String {
    if energy_j.abs() < 1e-3 {
        format!("{energy_j:.6e} J")
    } else {
        format!("{energy_j:.6} J")
    }
}

impl Checked {
    /// The results of the demands as JSON, for `--json`; `None` without demands.
    pub fn to_json(&self) -> Option<serde_json::Value> {
        let entry = |check: &Check| {
            serde_json::json!({
                "run": check.run,
                "option": check.option,
                "wanted": check.wanted,
                "came": check.came,
                "met": check.met,
            })
        };
        (!self.checks.is_empty()).then(|| self.checks.iter().map(entry).collect())
    }

    /// Writes the JUnit file, prints the demands that are not met, and returns the exit code. Also prints which runs were not
    /// judged although they meet their demands.
    pub fn conclude(&self) -> Result<ExitCode> {
        if let Some(file) = &self.junit {
            self.write(file)?;
        }
        let mut code = ExitCode::SUCCESS;
        for checks in self.of_each_run() {
            for check in checks.iter().filter(|check| !check.met) {
                let (wanted, came) = (&check.wanted, &check.came);
                let line = format!(
                    "not met: {}: required {wanted}, result {came} ({})",
                    check.option, check.run
                );
                eprintln!("{}", one_line(&line));
                code = ExitCode::from(NOT_MET);
            }
            if let (Some(why), true) = (unsaid(checks), checks.iter().any(|check| check.met)) {
                note!(
                    "note: the run is not judged, so a met demand does not show that the wall comes to rest: {why} ({})",
                    checks[0].run
                );
            }
        }
        Ok(code)
    }

    /// The checks of each run, in their order.
    fn of_each_run(&self) -> impl Iterator<Item = &[Check]> {
        self.checks.chunk_by(|one, next| one.run == next.run)
    }

    fn write(&self, file: &Path) -> Result<()> {
        let mut report = Report::new("touchstone");
        for checks in self.of_each_run() {
            report.add_test_suite(suite_of(checks));
        }
        let place = junit_file(file);
        let text = report
            .to_string()
            .map_err(|error| place.error(&std::io::Error::other(error)))?;
        let folder = file.parent().unwrap_or(file);
        output::in_folder(folder, |error| place.error(&error), || place.write(text))
    }
}

/// The path of the JUnit file. A JUnit file that this program wrote is replaced, so that a CI server can run the same command
/// again.
fn junit_file(path: &Path) -> Named<'_> {
    Named {
        path,
        option: "--junit",
        replaces: is_of_same_command(path, "<testsuites name=\"touchstone\""),
    }
}

/// Why a run was not judged, unless a demand on its verdict says so already.
fn unsaid(checks: &[Check]) -> Option<&str> {
    let of_verdict = |check: &Check| matches!(check.option, "--expect" | "--baseline");
    let why = checks.first()?.not_judged.as_deref();
    why.filter(|_| !checks.iter().any(of_verdict))
}

/// The JUnit tests of one run. If the run was not judged, a skipped test states the reason, unless the test of the verdict does.
/// The passed tests of such a run also print their measured values and the reason, so that they do not look like a wall that comes
/// to rest.
fn suite_of(checks: &[Check]) -> TestSuite {
    let run = &checks[0].run;
    let mut suite = TestSuite::new(run);
    let mut add = |name: String, status: TestCaseStatus, said: Option<String>| {
        let mut test = TestCase::new(name, status);
        test.set_classname(run);
        if let Some(said) = said {
            test.set_system_out(said);
        }
        suite.add_test_case(test);
    };
    for check in checks {
        let status = if check.met {
            TestCaseStatus::success()
        } else {
            let mut status = TestCaseStatus::non_success(NonSuccessKind::Failure);
            status.set_message(format!("required {}, result {}", check.wanted, check.came));
            status
        };
        let why = check.not_judged.as_ref().filter(|_| check.met);
        let said = why.map(|why| match check.option {
            "--expect" => format!("result {}", check.came),
            _ => format!("result {}; the run is {NOT_JUDGED}: {why}", check.came),
        });
        add(format!("{} {}", check.option, check.wanted), status, said);
    }
    if let Some(why) = unsaid(checks) {
        let mut status = TestCaseStatus::skipped();
        status.set_message(format!("{NOT_JUDGED}: {why}"));
        add("whether the wall rests".to_owned(), status, None);
    }
    suite
}

/// The results of runs with the results of the demands on them.
pub fn with_demands(mut results: serde_json::Value, checked: &Checked) -> serde_json::Value {
    if let Some(checks) = checked.to_json() {
        results["expectations"] = checks;
    }
    results
}

/// The results of runs, given as JSON text, with the results of the demands on them.
pub fn results(text: &str, checked: &Checked) -> serde_json::Value {
    debug_assert!(json());
    with_demands(serde_json::from_str(text).unwrap_or_default(), checked)
}
