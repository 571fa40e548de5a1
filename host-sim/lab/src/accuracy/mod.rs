//! What accuracy costs in time: work–precision diagrams of the plant, the law, the sampling and the closed loop.
//!
//! Times are of one machine at one hour: only those of one run are to be compared with each other.

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

use crate::report::ProgramVersion;
use choice::Chosen;
use closed::ClosedPoint;
use law::LawPoint;
use plant::Diagram;
use problem::Problem;
use sampling::SamplingPoint;

/// One count of the encoder that errors are measured against, rad: 40,000 counts a turn.
pub const COUNT_RAD: f64 = std::f64::consts::TAU / 40_000.0;
/// The step of force of the 32-bit format, N·m.
pub const FORCE_QUANTUM_N_M: f64 = 1.0 / 16_777_216.0;

/// How much is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Options {
    /// Fewer substeps, rates and repeats: to see that it works, not to publish.
    pub quick: bool,
}

impl Options {
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

    /// Rounds of progress that a run has.
    #[must_use]
    pub fn rounds(self) -> u64 {
        // Four problems and the laws, each so many times; sampling and closed loop.
        u64::from(5 * self.repeats()) + 2
    }
}

/// The machine on which it ran.
#[derive(Debug, Clone, Serialize)]
pub struct Machine {
    /// Processor, as the system names it; `unknown` where it does not.
    pub cpu: String,
    /// Compiler that the program was built with.
    pub compiler: String,
    /// Whether the program was built with optimisation for speed; if not, no time in here means anything.
    pub optimised: bool,
}

impl Machine {
    /// The machine that this runs on.
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

/// Everything that was found.
#[derive(Debug, Clone, Serialize)]
pub struct Accuracy {
    /// Version of this layout.
    pub schema_version: u32,
    /// The program.
    pub program: ProgramVersion,
    /// The machine on which it ran.
    pub machine: Machine,
    /// The command line that makes it again.
    pub command: String,
    /// Files of the folder; empty without one.
    pub files: Vec<String>,
    /// Whether it is a quick run.
    pub quick: bool,
    /// Repeats of every time.
    pub repeats: u32,
    /// One encoder count, rad.
    pub count_rad: f64,
    /// One step of force of the 32-bit format, N·m.
    pub force_quantum_n_m: f64,
    /// Plant: every method on every problem.
    pub plant: Vec<Diagram>,
    /// The choices that keep the error within a count.
    pub within_a_count: Vec<Chosen>,
    /// Law: every number format.
    pub law: Vec<LawPoint>,
    /// Sampling: every rate and encoder.
    pub sampling: Vec<SamplingPoint>,
    /// Closed loop: every method.
    pub closed_loop: Vec<ClosedPoint>,
}

/// Measures everything. `on_round` is called [`Options::rounds`] times.
///
/// # Errors
/// A shipped scene that cannot be run.
pub fn measure(
    options: Options,
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
                fix: "report it: the problem is the program's own".to_owned(),
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
