//! Tries effects that a scene does not have, each alone at its typical magnitude, and finds those that would change the scene's
//! results.

use serde::Serialize;
use touchstone_control::LawKind;
use touchstone_sim::error::Result;
use touchstone_sim::run;
use touchstone_sim::run::effects::{EFFECTS, Effect, Place, exclude_each_other};
use touchstone_sim::run::record::Summary;
use touchstone_sim::scene::Scene;

/// A result of a run, before and after an effect is added.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Moved {
    /// Name of the result, as in `results.json`.
    pub output: &'static str,
    /// The result without the effect; `None` if it does not apply.
    pub without: Option<f64>,
    /// The result with the effect; `None` if it does not apply.
    pub with: Option<f64>,
}

/// A simulated effect that the scene does not have, with the results that it would change.
#[derive(Debug, Clone, Serialize)]
pub struct Omitted {
    /// Name of the simulated effect.
    pub name: &'static str,
    /// Key or table of the scene file that would add the effect.
    pub field: &'static str,
    /// Magnitude at which the effect was tried, in words.
    pub typical: &'static str,
    /// Source of the typical magnitude.
    pub source: &'static str,
    /// Verdict on the run with the effect, if it differs from the verdict without the effect.
    pub verdict: Option<&'static str>,
    /// Results that the effect changes by more than the tolerance.
    pub moves: Vec<Moved>,
    /// Reason why the effect was not tried.
    pub not_tried: Option<String>,
}

/// A result of a run, with the largest change that counts as negligible.
struct Output {
    name: &'static str,
    of: fn(&Summary) -> Option<f64>,
    /// Largest negligible change, in the result's unit; the argument is the angle of an encoder count in rad.
    floor: fn(f64) -> f64,
}

/// Largest negligible change of a torque, N·m: a thousandth of the torque of the thesis' press.
const TORQUE_N_M: f64 = 1e-4;
/// Largest negligible change of an energy, J. Rounding of sums over many ticks is of this size.
const ENERGY_J: f64 = 1e-7;

const OUTPUTS: &[Output] = &[
    Output {
        name: "k_displayed",
        of: |summary| summary.k_displayed,
        floor: |_| 0.0,
    },
    Output {
        name: "peak_penetration_ratio",
        of: |summary| summary.peak_penetration_ratio,
        floor: |_| 0.0,
    },
    Output {
        name: "penetration_max",
        of: |summary| Some(summary.penetration_max),
        floor: |count| count,
    },
    Output {
        name: "limit_cycle_peak_to_peak",
        of: |summary| summary.limit_cycle_peak_to_peak,
        floor: |count| count,
    },
    Output {
        name: "force_max",
        of: |summary| Some(summary.force_max),
        floor: |_| TORQUE_N_M,
    },
    Output {
        name: "ripple_rms_n_m",
        of: |summary| summary.ripple_rms_n_m,
        floor: |_| TORQUE_N_M,
    },
    Output {
        name: "energy_out",
        of: |summary| Some(summary.energy_out),
        floor: |_| ENERGY_J,
    },
    Output {
        name: "energy_out_worst_window_j",
        of: |summary| Some(summary.energy_out_worst_window_j),
        floor: |_| ENERGY_J,
    },
    Output {
        name: "release_speed_rad_per_s",
        of: |summary| summary.release_speed_rad_per_s,
        floor: |_| 0.0,
    },
];

/// Change of the start angle, or of the wall's angle if the scene sets no start angle, that measures the loop's own sensitivity,
/// rad.
const NUDGE_RAD: f64 = 1e-9;

/// Simulated effects that the scene does not have.
pub fn untried(scene: &Scene) -> impl Iterator<Item = &'static Effect> {
    let named = |effect: &Effect| (effect.is_named)(scene);
    EFFECTS.iter().filter(move |effect| {
        let excluded = |other: &Effect| named(other) && exclude_each_other(effect, other);
        !named(effect) && !EFFECTS.iter().any(excluded)
    })
}

/// Simulates the scene with each effect that it does not have, one at a time, and calls `step` for each. Effects that exclude an
/// effect of the scene are left out.
///
/// # Errors
/// The scene cannot be run.
pub fn all(scene: &Scene, tolerance: f64, step: &mut dyn FnMut()) -> Result<Vec<Omitted>> {
    let plain = run::run(scene, false)?.summary;
    let nudged = scene.with(|scene| {
        if let Some(angle) = &mut scene.device.initial_angle_rad {
            *angle += NUDGE_RAD;
        } else {
            scene.wall.surface_rad += NUDGE_RAD;
        }
    })?;
    let nudged = run::run(&nudged, false)?.summary;
    let count = scene
        .encoder
        .as_ref()
        .map_or(std::f64::consts::TAU / 40_000.0, |encoder| {
            encoder.step_rad()
        });
    Ok(untried(scene)
        .map(|effect| {
            step();
            let mut found = Omitted {
                name: effect.name,
                field: effect.field,
                typical: effect.typical,
                source: effect.source,
                verdict: None,
                moves: Vec::new(),
                not_tried: None,
            };
            if effect.of_hand && scene.operator.hand().is_none() {
                found.not_tried = Some("no hand holds the device".to_owned());
                return found;
            }
            if effect.place == Place::Velocity && scene.law.kind != LawKind::SpringDamper {
                found.not_tried = Some("the law takes no velocity".to_owned());
                return found;
            }
            match scene
                .with(effect.add)
                .and_then(|scene| run::run(&scene, false))
            {
                Err(error) => found.not_tried = Some(error.to_string()),
                Ok(run) => {
                    let with = run.summary;
                    found.verdict = (with.verdict != plain.verdict).then(|| with.verdict.name());
                    found.moves = OUTPUTS
                        .iter()
                        .filter_map(|output| {
                            moved(output, [&plain, &nudged, &with], tolerance, count)
                        })
                        .collect();
                }
            }
            found
        })
        .collect())
}

/// Returns the result if the effect changes it significantly. The change must exceed the tolerance, a negligible change, and
/// three times the change that a move by [`NUDGE_RAD`] causes. A result that appears or disappears is returned too.
fn moved(
    output: &Output,
    [plain, nudged, with]: [&Summary; 3],
    tolerance: f64,
    count: f64,
) -> Option<Moved> {
    let [without, own, with] = [plain, nudged, with].map(|summary| (output.of)(summary));
    let told = Moved {
        output: output.name,
        without,
        with,
    };
    let (Some(a), Some(b)) = (without, with) else {
        return (without.is_some() != with.is_some()).then_some(told);
    };
    let by_itself = own.map_or(0.0, |own| (own - a).abs());
    let least = (tolerance * a.abs().max(b.abs()))
        .max((output.floor)(count))
        .max(3.0 * by_itself);
    // A result that became infinite or NaN counts as changed.
    ((b - a).abs() > least || !(b - a).is_finite()).then_some(told)
}
