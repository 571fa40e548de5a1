//! Which property of the knob would have to differ, and by how much, to make the simulation match the recording; each
//! alone.

use super::replay::Replay;
use super::{closest, rms};
use rayon::iter::{IntoParallelRefIterator, ParallelIterator};
use serde::Serialize;
use touchstone_sim::error::Result;
use touchstone_sim::scene::Scene;

/// The best of one value.
#[derive(Debug, Clone, Serialize)]
pub struct Fit {
    /// The field of the scene.
    pub field: &'static str,
    /// How much larger it would be than the scene says.
    pub factor: f64,
    /// What then stays, rms of the position's difference, rad.
    pub rms_rad: f64,
}

/// A value of the knob.
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

/// Half to double: beyond, it is another knob.
const WIDEST: f64 = 2.0;
/// Looks on a grid of factors, equal by their ratio, before the best is closed in.
const GRID: i32 = 12;
/// Halvings of a grid's step: to 0.4 %.
const CLOSER: u32 = 4;

/// Each value's best factor; the best value first.
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
