//! How a scene's run is built: states, eigenvalues, how the plant crosses a tick and why, the cost of every effect,
//! and which omitted effects would change the result.

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
use crate::report::ProgramVersion;
pub use equations::Eigenvalue;
pub use omitted::{Moved, Omitted};

/// Options of a plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Asked {
    /// Share by which an output may move before an effect is listed.
    pub tolerance: f64,
    /// Whether runs are timed.
    pub times: bool,
    /// Whether effects that the scene does not name are tried.
    pub omitted: bool,
}

impl Default for Asked {
    fn default() -> Self {
        Asked {
            tolerance: 0.05,
            times: true,
            omitted: true,
        }
    }
}

/// An effect that a scene names.
#[derive(Debug, Clone, Serialize)]
pub struct Named {
    /// Name of the effect.
    pub name: &'static str,
    /// Where it stands in the loop.
    pub place: &'static str,
    /// Instructions a tick that it adds alone at its typical magnitude, of the ladder.
    pub instructions: Option<f64>,
    /// Time of this scene's tick with the effect less that without it, least of the repeats, ns; `None` where it was
    /// not measured, or the scene needs the effect.
    pub ns: Option<f64>,
}

/// A scene's plan.
#[derive(Debug, Clone, Serialize)]
pub struct Planned {
    /// Version of this layout.
    pub schema_version: u32,
    /// The program.
    pub program: ProgramVersion,
    /// The scene.
    pub scene: String,
    /// What changes between two ticks.
    pub states: Vec<String>,
    /// Eigenvalues of the linear part.
    pub eigenvalues: Vec<Eigenvalue>,
    /// How the plant crosses a tick.
    pub tier: String,
    /// Substeps of a tick; 1 for an exact step.
    pub substeps: u32,
    /// The code of the fault.
    pub reasons: Vec<String>,
    /// Effects that the scene names.
    pub effects: Vec<Named>,
    /// Instructions a tick by the ladder: the bare loop, the law, each effect and what each pair adds beyond both, at typical magnitudes.
    pub predicted_instructions: Option<f64>,
    /// Measured time of a tick without a recorder.
    pub measured: Option<Spread>,
    /// Effects that it does not name, tried one by one.
    pub omitted: Vec<Omitted>,
    /// Share by which an output may move before an effect is listed.
    pub tolerance: f64,
}

/// How often [`plan`] calls its `step`.
#[must_use]
pub fn steps(scene: &Scene, asked: Asked) -> u64 {
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

/// Plans a scene, and measures what the options want. `step` is called after each round of timing and for each effect that is tried.
///
/// # Errors
/// A scene that cannot be run.
pub fn plan(
    scene: &Scene,
    asked: Asked,
    program: ProgramVersion,
    step: &mut dyn FnMut(),
) -> Result<Planned> {
    // What a run would be refused for is refused here.
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

/// How the plant crosses a tick, in how many substeps, and why.
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
