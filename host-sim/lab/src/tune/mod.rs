//! Tunes a control law for a device: finds settings with which the law renders the requested wall. The device is given by inertia,
//! damping, friction, encoder counts, delay, torque limit and control rate.
//!
//! Settings are evaluated by the measures of their [scorecard](crate::scorecard), over three simulated grips (light, medium,
//! firm) and every varied device, including the torque ripple. [`search`] minimises the sum by which the measures exceed their
//! limits ([`cost`]), starting from a rule in [`parameters`]. [`settings`] writes the result, [`own_firmware`] as Rust and C.
//! [`pareto`] shows the trade-off between stiffness, ripple and delay.

pub mod campaign;
pub mod cost;
pub mod diagnosis;
mod eigenvalue;
mod evolution;
pub mod linear;
pub mod outcome;
pub mod own_firmware;
pub mod parameters;
pub mod pareto;
pub mod search;
pub mod settings;
#[cfg(test)]
mod tests;

use crate::scorecard::reference::Reference;
use crate::scorecard::rivals::Rival;
use cost::{Cost, Judgement};
use parameters::{Axis, at, axes};
use touchstone_control::choices::StatesKind;
use touchstone_sim::error::Result;
use touchstone_sim::scene::Scene;

/// Options of a search for settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TuneOptions {
    /// Seed of the random numbers; the same seed finds the same settings.
    pub seed: u64,
    /// Length of the search for settings.
    pub effort: Effort,
    /// Largest allowed ripple (change of the torque from tick to tick, rms) on the nominal device, N·m; absent: the limit of
    /// [`Reference`].
    pub ripple_n_m: Option<f64>,
}

/// Length of the search, in simulated control periods instead of seconds, so that every machine finds the same settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Effort {
    /// Full search on all devices; takes a minute and a half on two cores.
    Full,
    /// Quick search with the most decisive devices and shorter presses; takes some seconds.
    Quick,
    /// Devices and presses as for `Quick`, with this number of simulated ticks (control periods).
    Ticks(f64),
}

impl Effort {
    /// Largest number of simulated ticks (control periods). A tick takes about 250 ns to compute if dry friction holds the device
    /// most of the time.
    const fn ticks(self) -> f64 {
        match self {
            Effort::Full => 6.0e8,
            Effort::Quick => 4.0e7,
            Effort::Ticks(ticks) => ticks,
        }
    }

    /// Whether only the most decisive devices are simulated.
    #[must_use]
    pub fn is_quick(self) -> bool {
        self != Effort::Full
    }
}

/// Largest number of settings that are examined per tuned parameter. A longer search makes no progress.
const LOOKS_PER_PARAMETER: f64 = 400.0;

/// Result of tuning: a control law with its settings.
#[derive(Debug, Clone)]
pub struct Tuned {
    /// The control law that was tuned.
    pub rival: &'static Rival,
    /// The scene with the tuned settings of the law.
    pub scene: Scene,
    /// The tuned settings, each with its dotted path in the scene file and its value.
    pub parameters: Vec<(&'static str, f64)>,
    /// Largest ratio of a measure to its limit, over the devices and presses of the search.
    pub worst: f64,
    /// Number of settings that were examined.
    pub evaluations: u64,
    /// The spring-damper from whose torque ripple the limit of the ripple was computed.
    pub reference: Reference,
    /// Seed of the search's random numbers.
    pub seed: u64,
}

/// Tunes a law for the device and wall of a scene. Calls `progress` with the finished and the total number of settings.
///
/// # Errors
/// The reference spring-damper cannot run in the scene.
pub fn tune(
    scene: &Scene,
    rival: &'static Rival,
    options: &TuneOptions,
    mut progress: impl FnMut(u64, u64),
) -> Result<Tuned> {
    let mut reference = Reference::of(scene)?;
    if let Some(limit) = options.ripple_n_m {
        reference.limit_n_m = limit;
    }
    let judgement = Judgement::new(scene, reference, options.effort.is_quick());
    let looks = Looks {
        most: options.effort.ticks() / judgement.ticks(scene),
        // No goal: the search uses its whole budget.
        enough: 0.0,
        seed: options.seed,
    };
    let mut tuned = search_by(scene, rival, reference, &judgement, looks, &mut progress);
    choose_pulse(scene, &mut tuned, &judgement);
    Ok(no_worse_than_own(scene, tuned, &judgement))
}

/// Pulses at the touch that are tried, as shares of the device's momentum.
const PULSES: [f64; 4] = [0.3, 0.5, 0.7, 1.0];

/// Sets the pulse at the touch to the tried value, or to none, with the least cost over all devices. Values that raise the worst
/// measure above both its limit and its value without a pulse are left out. A device of half the inertia bounces off a wall with
/// little damping if the pulse is large. A law on measured states, and a scene without a pulse, stay without a pulse.
fn choose_pulse(scene: &Scene, tuned: &mut Tuned, judgement: &Judgement) {
    let asked = scene.law.impact.share_of_momentum > 0.0;
    if !asked || tuned.scene.law.states != StatesKind::Estimated {
        return;
    }
    let whole = Judgement::new(scene, tuned.reference, false);
    let costs = |scene: &Scene| [judgement.cost(scene), whole.cost(scene)];
    let without = costs(&tuned.scene);
    let (mut least, mut chosen) = (without, tuned.scene.clone());
    let inertias = scene.device.inertia_kg_m2 / tuned.scene.law.estimator.inertia_kg_m2;
    for pulse in PULSES {
        let mut tried = tuned.scene.clone();
        tried.law.impact.share_of_momentum =
            parameters::rounded((pulse * inertias).min(MOST_PULSE));
        let found = costs(&tried);
        let mut both = found.iter().zip(&without);
        let holds = both.all(|(found, without)| found.worst <= without.worst.max(1.0));
        if holds && found[1].value <= least[1].value {
            (least, chosen) = (found, tried);
        }
    }
    tuned.evaluations += PULSES.len() as u64;
    let share = chosen.law.impact.share_of_momentum;
    let pulse = ("law.impact.share_of_momentum", share);
    (tuned.scene, tuned.worst) = (chosen, least[0].worst);
    tuned.parameters.push(pulse);
}

/// Largest value of the setting `law.impact.share_of_momentum`.
const MOST_PULSE: f64 = 2.0;

/// Returns the tuned settings, or the scene's own law settings with the tuned energy guard if these are better. All devices are
/// simulated for this comparison, even after a quick search.
fn no_worse_than_own(scene: &Scene, mut tuned: Tuned, judgement: &Judgement) -> Tuned {
    let mut own = tuned.rival.of(scene);
    own.law.states = tuned.scene.law.states;
    own.law.guard = tuned.scene.law.guard.clone();
    own.law.force_limit_n_m = tuned.scene.law.force_limit_n_m;
    let whole = Judgement::new(scene, tuned.reference, false);
    if whole.cost(&own).value < whole.cost(&tuned.scene).value {
        tuned.worst = judgement.cost(&own).worst;
        tuned.parameters = values(&axes(tuned.rival, scene), &mut own);
        tuned.scene = own;
    }
    tuned
}

/// Limits at which a search for settings ends.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Looks {
    /// Largest number of settings to examine.
    most: f64,
    /// Largest ratio of a measure to its limit at which the search ends early.
    enough: f64,
    seed: u64,
}

/// Largest ratio of a measure to its limit at which a search ends early, if the wall only has to come to rest and have the right
/// stiffness.
const ENOUGH: f64 = 0.7;

/// Tunes a law with at most `ticks` simulated ticks. The goals are a press that comes to rest in every grip, and the requested
/// stiffness for an oscillating hand, by the limits of [`outcome`]. Torque ripple does not count.
#[must_use]
pub fn to_rest(scene: &Scene, rival: &'static Rival, ticks: f64, seed: u64) -> Tuned {
    let reference = Reference::none();
    let judgement = Judgement::at_rest(scene, reference);
    let looks = Looks {
        most: ticks / judgement.ticks(scene),
        enough: ENOUGH,
        seed,
    };
    search_by(scene, rival, reference, &judgement, looks, &mut |_, _| ())
}

/// The scene with the law's settings that have the best eigenvalues of the loop, found without a simulated run. A law that matrices
/// do not describe gets the settings of the start rule.
#[must_use]
pub fn by_matrices(scene: &Scene, rival: &'static Rival, seed: u64) -> Scene {
    let axes = axes(rival, scene);
    let point = match axes.is_empty() || !rival.is_linear() {
        true => vec![0.0; axes.len()],
        false => linear::start(rival, scene, &axes, &starts(scene, &axes), seed),
    };
    at(rival, scene, &axes, &point)
}

/// Tunes a law with the given evaluation of settings.
fn search_by(
    scene: &Scene,
    rival: &'static Rival,
    reference: Reference,
    judgement: &Judgement,
    looks: Looks,
    progress: &mut dyn FnMut(u64, u64),
) -> Tuned {
    let axes = axes(rival, scene);
    let most = looks
        .most
        .min(LOOKS_PER_PARAMETER * axes.len() as f64)
        .max(4.0) as u64;
    let mut starts = starts(scene, &axes);
    if !axes.is_empty() && rival.is_linear() {
        starts.push(linear::start(rival, scene, &axes, &starts, looks.seed));
    }
    let found = search::minimise(
        &starts,
        &search::Until {
            evaluations: most,
            worst: looks.enough,
            seed: looks.seed,
        },
        |point| judgement.cost(&at(rival, scene, &axes, point)),
        |done| progress(done, most),
    );
    let mut scene = at(rival, scene, &axes, &found.point);
    let parameters = values(&axes, &mut scene);
    let Cost { worst, .. } = found.cost;
    Tuned {
        rival,
        scene,
        parameters,
        worst,
        evaluations: found.evaluations,
        reference,
        seed: looks.seed,
    }
}

/// Dotted path and value of every tuned setting.
fn values(axes: &[Axis], scene: &mut Scene) -> Vec<(&'static str, f64)> {
    let mut of = |axis: &Axis| (axis.parameter.path, *(axis.parameter.of)(&mut scene.law));
    axes.iter().map(&mut of).collect()
}

/// Start points of a search: the rule for the device, the scene's own settings, and known good settings for soft and for stiff
/// walls.
fn starts(scene: &Scene, axes: &[Axis]) -> Vec<Vec<f64>> {
    let mut own = scene.law.clone();
    let own: Vec<f64> = axes
        .iter()
        .map(|axis| {
            let value = *(axis.parameter.of)(&mut own);
            (value.clamp(axis.least, axis.most) / axis.start).ln()
        })
        .collect();
    let mut starts = vec![vec![0.0; axes.len()], own];
    starts.extend(KNOWN.iter().map(|known| {
        axes.iter()
            .map(|axis| {
                known
                    .iter()
                    .find(|(path, _)| *path == axis.parameter.path)
                    .map_or(0.0, |(_, ratio)| ratio.ln())
            })
            .collect()
    }));
    starts
}

/// Known good settings for the thesis' knob, each divided by the value of the start rule. They are for walls of 5 and 20 times the
/// critical stiffness, the largest that sampling allows a plain spring. One more is for a damped wall of 14 times, which passes on
/// every device variant.
const KNOWN: [&[(&str, f64)]; 3] = [
    &[
        ("law.limit_of_penetration_per_ms", 11.4),
        ("law.limit_of_force_per_ms", 1.49),
        ("law.step_of_ideal_per_ms", 0.98),
        ("law.filter.mass_kg_m2", 0.23),
        ("law.filter.stiffness_n_m_per_rad", 2.96),
        ("law.filter.damping_n_m_s_per_rad", 1.13),
        ("law.filter.ground_damping_n_m_s_per_rad", 0.106),
        ("law.k_soft_n_m_per_rad", 1.3),
        ("law.virtual_damping_n_m_s_per_rad", 0.75),
        ("law.estimator.bandwidth_hz", 1.25),
        ("law.estimator.delay_s", 1.9),
        ("law.estimator.inertia_kg_m2", 0.95),
    ],
    &[
        ("law.limit_of_penetration_per_ms", 0.97),
        ("law.filter.mass_kg_m2", 2.3),
        ("law.filter.stiffness_n_m_per_rad", 0.34),
        ("law.filter.ground_damping_n_m_s_per_rad", 3.3),
        ("law.k_soft_n_m_per_rad", 0.95),
        ("law.virtual_damping_n_m_s_per_rad", 1.05),
        ("law.estimator.bandwidth_hz", 0.93),
        ("law.estimator.inertia_kg_m2", 1.5),
    ],
    &[
        ("law.limit_of_penetration_per_ms", 0.196),
        ("law.limit_of_force_per_ms", 0.239),
        ("law.step_of_ideal_per_ms", 0.0644),
        ("law.filter.mass_kg_m2", 3.0),
        ("law.filter.stiffness_n_m_per_rad", 10.0),
        ("law.filter.damping_n_m_s_per_rad", 0.577),
        ("law.filter.ground_damping_n_m_s_per_rad", 0.183),
        ("law.k_soft_n_m_per_rad", 1.3),
        ("law.virtual_damping_n_m_s_per_rad", 16.0),
        ("law.estimator.bandwidth_hz", 1.14),
        ("law.estimator.delay_s", 1.47),
        ("law.estimator.inertia_kg_m2", 0.69),
    ],
];
