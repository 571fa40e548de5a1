//! Settings for a device: from inertia, damping, friction, counts, delay, torque limit and rate to a law that displays
//! the wanted wall.
//!
//! A setting is judged by the worst figure of its [scorecard](crate::scorecard) over three grips and every device of
//! its cases, the limit of its ripple among them. [`search`] makes that small, starting from a rule in [`parameters`].
//! [`settings`] writes the result, [`pareto`] shows the cost of more stiffness, less ripple or more delay.

pub mod campaign;
pub mod cost;
pub mod diagnosis;
mod eigenvalue;
mod evolution;
pub mod linear;
pub mod outcome;
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
use touchstone_sim::error::Result;
use touchstone_sim::scene::Scene;

/// Options of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Seed: the same finds the same.
    pub seed: u64,
    /// How long it may look.
    pub effort: Effort,
    /// What ripple may be on the nominal device, N·m; absent: [`Reference`].
    pub ripple_n_m: Option<f64>,
}

/// How long a search may look. Counted in simulated ticks and not in seconds, so that every machine finds the same.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Effort {
    /// All devices: a minute and a half on two cores.
    Full,
    /// The devices that decide most, shorter presses: some seconds.
    Quick,
    /// As quick, with this many ticks.
    Ticks(f64),
}

impl Effort {
    /// Most ticks: some 250 ns each where dry friction holds the device most of the time.
    const fn ticks(self) -> f64 {
        match self {
            Effort::Full => 6.0e8,
            Effort::Quick => 4.0e7,
            Effort::Ticks(ticks) => ticks,
        }
    }

    /// Whether not all devices are examined.
    #[must_use]
    pub fn is_quick(self) -> bool {
        self != Effort::Full
    }
}

/// Most looks for each parameter: by then a search stands still.
const LOOKS_PER_PARAMETER: f64 = 400.0;

/// A law with settings that were found.
#[derive(Debug, Clone)]
pub struct Tuned {
    /// The law in use.
    pub rival: &'static Rival,
    /// The scene with the tuned law.
    pub scene: Scene,
    /// The tuned settings: path and value.
    pub parameters: Vec<(&'static str, f64)>,
    /// The largest share of a limit in the search's own, shorter programme.
    pub worst: f64,
    /// Points that were examined.
    pub evaluations: u64,
    /// What ripple was measured by.
    pub reference: Reference,
    /// Seed of the search.
    pub seed: u64,
}

/// Tunes a law for the device and wall of a scene; `progress` gets the finished and the total work.
///
/// # Errors
/// A scene whose spring-damper cannot run.
pub fn tune(
    scene: &Scene,
    rival: &'static Rival,
    options: &Options,
    mut progress: impl FnMut(u64, u64),
) -> Result<Tuned> {
    let mut reference = Reference::of(scene)?;
    if let Some(limit) = options.ripple_n_m {
        reference.limit_n_m = limit;
    }
    let judgement = Judgement::new(scene, reference, options.effort.is_quick());
    let looks = Looks {
        most: options.effort.ticks() / judgement.ticks(scene),
        // As good as can be found.
        enough: 0.0,
        seed: options.seed,
    };
    let tuned = search_by(scene, rival, reference, &judgement, looks, &mut progress);
    Ok(no_worse_than_own(scene, tuned, &judgement))
}

/// The tuned settings; or the scene's own with the guard's values, where these are better in the whole programme on
/// all devices. Both are judged by more than a quick search tries.
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

/// How long a search looks, and from where.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Looks {
    /// Largest number of settings.
    most: f64,
    /// Largest share of a limit that needs no better.
    enough: f64,
    seed: u64,
}

/// A figure within this share of its limit needs no improvement, where a wall only has to hold.
const ENOUGH: f64 = 0.7;

/// Tunes a law with this many ticks, until a press in every grip comes to rest and a moving hand is held, by the
/// limits of [`outcome`]. Ripple is not judged.
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

/// The scene with a law's settings where its matrices are best, without a run; those of the rule for a law that has none.
#[must_use]
pub fn by_matrices(scene: &Scene, rival: &'static Rival, seed: u64) -> Scene {
    let axes = axes(rival, scene);
    let point = match axes.is_empty() || !rival.is_linear() {
        true => vec![0.0; axes.len()],
        false => linear::start(rival, scene, &axes, &starts(scene, &axes), seed),
    };
    at(rival, scene, &axes, &point)
}

/// Tunes by a judgement of one's own.
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

/// Path and value of every parameter.
fn values(axes: &[Axis], scene: &mut Scene) -> Vec<(&'static str, f64)> {
    let mut of = |axis: &Axis| (axis.parameter.path, *(axis.parameter.of)(&mut scene.law));
    axes.iter().map(&mut of).collect()
}

/// Starting points of a search: the rule, the scene's own settings, and earlier results for soft and for stiff walls.
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

/// Ratios to the rule of settings that were found for the thesis' knob, at 5 and at 20 times its critical stiffness, and as a damped wall that
/// holds the whole family at 14 times.
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
