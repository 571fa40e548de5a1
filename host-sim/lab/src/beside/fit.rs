//! Estimates which property of the knob would have to differ from the scene, and by how much, so that the simulation matches a
//! recording. Each property is varied alone.

use super::replay::Replay;
use super::{closest, rms};
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use serde::Serialize;
use touchstone_sim::error::Result;
use touchstone_sim::scene::Scene;

/// Best factor on one property of the simulated knob, with which the simulation matches a recording.
#[derive(Debug, Clone, Serialize)]
pub struct Fit {
    /// Dotted path of the property in the scene file.
    pub field: &'static str,
    /// Factor on the scene's value that matches the recording best.
    pub factor: f64,
    /// Root mean square difference of the position that remains with this factor, rad.
    pub rms_rad: f64,
}

/// Multiplies one property of the scene's device by a factor.
type Change = fn(&mut Scene, f64);

const VALUES: [(&str, Change); 3] = [
    ("device.inertia_kg_m2", |scene, factor| {
        scene.device.inertia_kg_m2 *= factor;
    }),
    ("device.damping_n_m_s_per_rad", |scene, factor| {
        scene.device.damping_n_m_s_per_rad *= factor;
    }),
    ("device.friction.kinetic_n_m", |scene, factor| {
        if let Some(friction) = &mut scene.device.friction {
            friction.kinetic_n_m *= factor;
            friction.static_n_m = friction.static_n_m.map(|it| it * factor);
            friction.asymmetry_n_m = friction.asymmetry_n_m.map(|it| it * factor);
        }
    }),
];

/// Largest factor on a property; the smallest is its reciprocal. A larger deviation would mean another knob.
const WIDEST: f64 = 2.0;
/// Number of steps in the grid of factors from the smallest to the largest, equal on a logarithmic scale. The grid is tried
/// before the search is refined.
const GRID: i32 = 12;
/// Number of times that the step of the factors is halved around the best factor; the last step is 0.7 %.
const CLOSER: u32 = 4;

/// Finds the best factor of each property; the property that matches best comes first.
pub fn fits(replay: &Replay<'_>) -> Result<Vec<Fit>> {
    let is_there =
        |field: &str| replay.scene().device.friction.is_some() || !field.contains("friction");
    let of = |(field, change): &(&'static str, Change)| {
        let cost = |power: f64| -> Result<f64> {
            let near = replay
                .scene()
                .with(|scene| change(scene, WIDEST.powf(power)))?;
            let run = replay.run(&near)?;
            Ok(rms(replay.recorded().penetration_rad, &run.penetration_rad))
        };
        let (power, rms_rad) = closest(2.0 / f64::from(GRID), GRID / 2, CLOSER, cost)?;
        Ok(Fit {
            field,
            factor: WIDEST.powf(power),
            rms_rad,
        })
    };
    let values = VALUES.par_iter().filter(|(field, _)| is_there(field));
    let mut all = values.map(of).collect::<Result<Vec<_>>>()?;
    all.sort_by(|a, b| a.rms_rad.total_cmp(&b.rms_rad));
    Ok(all)
}
