//! Measures how much computing time accuracy costs, for four parts of a simulation: the plant's integration methods, the control
//! laws' number formats, the sampling, and the closed loop.
//!
//! Computing times depend on the machine and its load, so compare only times of the same run.

pub mod board;
pub mod choice;
pub mod clock;
pub mod closed;
pub mod double;
pub mod figures;
pub mod law;
pub mod plant;
pub mod problem;
pub mod reference;
pub mod sampling;
pub mod schema;
pub mod table;

use serde::Serialize;
use touchstone_sim::error::{Error, Result};

use choice::Chosen;
use closed::ClosedPoint;
use law::LawPoint;
use plant::Diagram;
use problem::Problem;
use sampling::SamplingPoint;
use touchstone_report::ProgramVersion;

/// Angle of one encoder count at 40,000 counts per turn, rad. Errors are compared with this angle.
pub const COUNT_RAD: f64 = std::f64::consts::TAU / 40_000.0;
/// Resolution of a force in the 32-bit fixed-point format, N·m.
pub const FORCE_QUANTUM_N_M: f64 = 1.0 / 16_777_216.0;

/// Options of an accuracy measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct AccuracyOptions {
    /// Measures fewer substeps, rates and repeats. A quick run shows that the program works; its times are not for publication.
    pub quick: bool,
}

impl AccuracyOptions {
    fn substeps(self) -> &'static [u32] {
        if self.quick {
            &[1, 16, 64]
        } else {
            &[1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1024]
        }
    }

    fn repeats(self) -> u32 {
        if self.quick { 5 } else { 25 }
    }

    /// Number of progress reports during a run.
    #[must_use]
    pub fn rounds(self) -> u64 {
        // Four problems and the laws, each with this many repeats; then sampling and closed loop.
        u64::from(5 * self.repeats()) + 2
    }
}

/// The machine on which the measurement ran.
#[derive(Debug, Clone, Serialize)]
pub struct Machine {
    /// Processor name as the operating system gives it; `unknown` if it gives none.
    pub cpu: String,
    /// Compiler with which the program was built.
    pub compiler: String,
    /// Whether the program was built with optimisation for speed. If not, its computing times are not valid.
    pub optimised: bool,
}

impl Machine {
    /// Describes the machine on which the program is running.
    #[must_use]
    pub fn here(compiler: &str) -> Self {
        let cpu = std::fs::read_to_string("/proc/cpuinfo")
            .ok()
            .and_then(|text| {
                let line = text.lines().find(|line| line.starts_with("model name"))?;
                Some(line.split_once(':')?.1.trim().to_owned())
            })
            .unwrap_or_else(|| "unknown".to_owned());
        Machine {
            cpu,
            compiler: compiler.to_owned(),
            optimised: !cfg!(debug_assertions),
        }
    }
}

/// All results of an accuracy measurement.
#[derive(Debug, Clone, Serialize)]
pub struct Accuracy {
    /// Version of the results' format.
    pub schema_version: u32,
    /// Version of the program that measured.
    pub program: ProgramVersion,
    /// The machine on which the measurement ran.
    pub machine: Machine,
    /// Command line that repeats the measurement.
    pub command: String,
    /// Names of the files in the results' folder; empty if nothing is written to a folder.
    pub files: Vec<String>,
    /// Whether this was a quick run with fewer substeps, rates and repeats.
    pub quick: bool,
    /// Number of times that every computing time was measured.
    pub repeats: u32,
    /// Angle of one encoder count, rad.
    pub count_rad: f64,
    /// Resolution of a force in the 32-bit fixed-point format, N·m.
    pub force_quantum_n_m: f64,
    /// Results of the plant's integration: every method on every test problem.
    pub plant: Vec<Diagram>,
    /// For every problem, the fastest methods with an error within one encoder count.
    pub within_a_count: Vec<Chosen>,
    /// Results of the control laws in every number format.
    pub law: Vec<LawPoint>,
    /// Results of the sampling: every control law at every control rate and encoder resolution.
    pub sampling: Vec<SamplingPoint>,
    /// Results of the closed loop: every integration method on every scene.
    pub closed_loop: Vec<ClosedPoint>,
}

/// Runs all measurements. `on_round` is called [`AccuracyOptions::rounds`] times, to report progress.
///
/// # Errors
/// A shipped scene cannot be run.
pub fn measure(
    options: AccuracyOptions,
    program: ProgramVersion,
    machine: Machine,
    command: &str,
    mut on_round: impl FnMut(),
) -> Result<Accuracy> {
    let repeats = options.repeats();
    let mut plant = Vec::new();
    for problem in Problem::all(1000)? {
        let diagram = plant::diagram(&problem, options.substeps(), repeats, &mut on_round)
            .map_err(|invalid| Error::Option {
                option: problem.name.to_owned(),
                problem: invalid.to_string(),
                fix: "this is an error of the program; please report it".to_owned(),
            })?;
        plant.push(diagram);
    }
    let law = law::points(repeats, &mut on_round)?;
    let (rates, counts): (&[u32], &[u32]) = if options.quick {
        (&[1000, 5000], &[4_000, 40_000])
    } else {
        (
            &[500, 1000, 2000, 5000, 10_000, 20_000],
            &[4_000, 16_384, 40_000, 400_000],
        )
    };
    let sampling = sampling::points(rates, counts)?;
    on_round();
    let closed_loop = closed::points(if options.quick {
        &[1, 16]
    } else {
        &[1, 4, 16, 64, 256]
    })?;
    on_round();
    Ok(Accuracy {
        schema_version: 1,
        program,
        machine,
        command: command.to_owned(),
        files: Vec::new(),
        quick: options.quick,
        repeats,
        count_rad: COUNT_RAD,
        force_quantum_n_m: FORCE_QUANTUM_N_M,
        within_a_count: plant.iter().map(Chosen::of).collect(),
        plant,
        law,
        sampling,
        closed_loop,
    })
}

#[cfg(test)]
mod tests;
