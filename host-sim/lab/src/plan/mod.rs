//! Describes how the simulator runs a scene: states, eigenvalues, how the plant is advanced over a control period and why. Also
//! describes the computing cost of every effect, and which omitted effects would change the result.

mod cost;
mod equations;
mod omitted;
pub mod schema;
pub mod table;
#[cfg(test)]
mod tests;

use serde::Serialize;
use touchstone_control::Choice as _;
use touchstone_sim::error::Result;
use touchstone_sim::run::effects::EFFECTS;
use touchstone_sim::run::plan::Plan;
use touchstone_sim::run::train::Train;
use touchstone_sim::scene::{Integrator, Scene};

use crate::accuracy::clock::Spread;
pub use equations::Eigenvalue;
pub use omitted::{Moved, Omitted};
use touchstone_report::ProgramVersion;

/// Options for the description of how a scene is simulated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanOptions {
    /// Relative change above which a result counts as changed by an omitted effect.
    pub tolerance: f64,
    /// Whether the computing time of a tick (control period) is measured.
    pub times: bool,
    /// Whether effects that the scene does not have are tried, to see if they would change the result.
    pub omitted: bool,
}

impl Default for PlanOptions {
    fn default() -> Self {
        PlanOptions {
            tolerance: 0.05,
            times: true,
            omitted: true,
        }
    }
}

/// A simulated effect that the scene has, such as friction or a current loop.
#[derive(Debug, Clone, Serialize)]
pub struct Named {
    /// Name of the simulated effect.
    pub name: &'static str,
    /// Place in the control loop at which the effect acts, in words.
    pub place: &'static str,
    /// Counted instructions per tick (control period) that the effect alone adds to the bare loop, at its typical magnitude.
    pub instructions: Option<f64>,
    /// Computing time per tick that the effect adds to this scene, ns: difference of the least measured times with and without the
    /// effect. `None` if it was not measured, or if the scene cannot run without the effect.
    pub ns: Option<f64>,
}

/// Description of how the simulator runs a scene.
#[derive(Debug, Clone, Serialize)]
pub struct Planned {
    /// Version of the results' format.
    pub schema_version: u32,
    /// Version of the program.
    pub program: ProgramVersion,
    /// Name of the scene.
    pub scene: String,
    /// Names of the state variables of device and hand.
    pub states: Vec<String>,
    /// Eigenvalues of the linear part of device and hand.
    pub eigenvalues: Vec<Eigenvalue>,
    /// Method by which the plant (device and hand) is advanced over a control period, in words.
    pub tier: String,
    /// Substeps per control period; 1 for the closed-form solution.
    pub substeps: u32,
    /// Reasons for the method and the number of substeps, one sentence each.
    pub reasons: Vec<String>,
    /// Effects that the scene has, with their computing cost.
    pub effects: Vec<Named>,
    /// Predicted instructions per tick from counts at typical magnitudes: bare loop, law and each effect, plus what each pair of
    /// effects adds beyond the sum of the two; `None` if a count is missing.
    pub predicted_instructions: Option<f64>,
    /// Measured computing time per tick (control period) of a run without a recorder.
    pub measured: Option<Spread>,
    /// Effects that the scene does not have, each tried alone.
    pub omitted: Vec<Omitted>,
    /// Relative change above which a result counts as changed by an omitted effect.
    pub tolerance: f64,
}

/// Number of times that [`plan`] calls its argument `step`.
#[must_use]
pub fn steps(scene: &Scene, asked: PlanOptions) -> u64 {
    let rounds = if asked.times {
        u64::from(cost::REPEATS)
    } else {
        0
    };
    let tried = match asked.omitted {
        true => omitted::untried(scene).count() as u64,
        false => 0,
    };
    rounds + tried
}

/// Describes how the simulator runs a scene, with the measurements that the options request. Calls `step` after each round of
/// timing and for each effect that is tried.
///
/// # Errors
/// The scene cannot be run.
pub fn plan(
    scene: &Scene,
    asked: PlanOptions,
    program: ProgramVersion,
    step: &mut dyn FnMut(),
) -> Result<Planned> {
    // Refuses a scene that a run would refuse.
    Plan::of(scene)?;
    let (tier, substeps, reasons) = tier(scene);
    let named: Vec<_> = EFFECTS
        .iter()
        .filter(|effect| (effect.is_named)(scene))
        .collect();
    let ladder = cost::Ladder::known();
    let (measured, ns) = if asked.times {
        let (whole, without) = cost::times(scene, &named, step)?;
        (Some(whole), without)
    } else {
        (None, vec![None; named.len()])
    };
    let effects = named
        .iter()
        .zip(ns)
        .map(|(effect, ns)| Named {
            name: effect.name,
            place: effect.place.words(),
            instructions: ladder.alone(effect.name),
            ns,
        })
        .collect();
    let names: Vec<&str> = named.iter().map(|effect| effect.name).collect();
    Ok(Planned {
        schema_version: 1,
        program,
        scene: scene.name.clone(),
        states: equations::states(scene),
        eigenvalues: equations::eigenvalues(scene)?,
        tier,
        substeps,
        reasons,
        effects,
        predicted_instructions: ladder.predicted(scene, &names),
        measured,
        omitted: if asked.omitted {
            omitted::all(scene, asked.tolerance, step)?
        } else {
            Vec::new()
        },
        tolerance: asked.tolerance,
    })
}

/// Method by which the plant is advanced over a control period, the number of substeps, and the reasons.
fn tier(scene: &Scene) -> (String, u32, Vec<String>) {
    let timing = &scene.timing;
    let mut reasons = Vec::new();
    let (tier, substeps) = if let Some(train) = Train::of(scene) {
        reasons.extend(train.reasons.iter().cloned());
        if train.substeps == 1 {
            reasons.push("a current that lags and a transmission are linear: further states of one matrix step".to_owned());
            ("exact step".to_owned(), 1)
        } else {
            let words = "exact step of what is linear, in substeps for what is not".to_owned();
            (words, train.substeps)
        }
    } else if let Some(plant) = scene
        .plant
        .as_ref()
        .filter(|plant| plant.integrator != Integrator::Exact)
    {
        reasons.push("plant.integrator asks for it".to_owned());
        (plant.integrator.word().to_owned(), plant.substeps)
    } else if scene.device.friction.is_some() {
        reasons.push(
            "dry friction is a constant torque between stops, and the stops are solved for"
                .to_owned(),
        );
        ("exact step with stops and starts located".to_owned(), 1)
    } else {
        reasons.push(
            "torque and rest point are held: everything between two ticks is linear".to_owned(),
        );
        ("exact step".to_owned(), 1)
    };
    if timing.jitter_s.is_some_and(|most| most > 0.0)
        || timing.latency_spread_s.is_some_and(|most| most > 0.0)
    {
        reasons.push("ticks or commands come late by chance: a tick is crossed in parts of a period, each as above".to_owned());
    } else if timing.computational_delay_s > 0.0 {
        reasons.push("a delayed command begins within a tick: two parts, each as above".to_owned());
    }
    (tier, substeps, reasons)
}
