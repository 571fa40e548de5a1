//! A scorecard: measures of how well several control laws render a wall, on the nominal device and on varied devices.
//!
//! [`cases`] has the devices and the hand's actions, [`family`] devices that vary in all properties at once. [`measure`] has the
//! measures with their limits, [`watch`] computes them from one run. [`rivals`] has the control laws, [`mod@reference`] the limit
//! of the torque ripple. Every measure is the worst of three simulated grips (light, medium, firm). [`words`] says in sentences
//! where each law fails and where a spring with damping does better; [`page`] formats the results for readers.

pub mod cases;
pub mod direction;
pub mod family;
pub mod family_page;
pub mod feel;
pub mod in_turn;
pub mod measure;
pub mod noticed;
pub mod on_board;
pub mod on_board_page;
pub mod on_device;
pub mod on_device_page;
pub mod page;
pub mod press;
pub mod reference;
mod rhythm;
pub mod rivals;
#[cfg(test)]
mod tests;
pub mod touch;
pub mod touch_ratios;
pub mod touched;
pub mod watch;
pub mod words;

use cases::{CASES, Case, Deed, GRIPS, Programme};
use measure::{Beside, Figures, Limits, Measure};
use rayon::prelude::*;
use reference::Reference;
use rivals::Rival;
use serde::Serialize;
use touch::IdealTouch;
use touch_ratios::TouchRatios;
use touchstone_sim::error::Result;
use touchstone_sim::scene::Scene;

/// Results of one law on one device.
#[derive(Debug, Clone, Serialize)]
pub struct Cell {
    /// Name of the device.
    pub case: &'static str,
    /// Measures with a limit, the worst of three simulated grips (light, medium, firm).
    pub figures: Figures,
    /// Measures without a limit, the worst of three simulated grips (light, medium, firm).
    pub beside: Beside,
    /// Limits of the measures on this device.
    pub limits: Limits,
    /// The measure that is largest relative to its limit, and its value divided by the limit. Above 1 the law fails on the device;
    /// `None` stands for infinite.
    pub worst: (Measure, Option<f64>),
}

impl Cell {
    pub(crate) fn new(case: &Case, figures: Figures, beside: Beside, limits: Limits) -> Self {
        let shares = figures.shares(&limits);
        let (measure, share) = Measure::ALL
            .into_iter()
            .zip(shares)
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or((Measure::PeakPenetrationRatio, f64::INFINITY));
        Self {
            case: case.name,
            figures,
            beside,
            limits,
            worst: (measure, share.is_finite().then_some(share)),
        }
    }

    /// Whether every measure is within its limit.
    #[must_use]
    pub fn passes(&self) -> bool {
        self.worst.1.is_some_and(|share| share <= 1.0)
    }
}

/// Results of one law on all devices.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    /// Name of the control law.
    pub law: &'static str,
    /// Description of the control law in a few words.
    pub about: &'static str,
    /// Publication or other source of the law.
    pub source: &'static str,
    /// Whether the law's settings were tuned for this device; otherwise they are the scene's.
    pub tuned: bool,
    /// Whether the law is a spring with virtual damping.
    pub damped_spring: bool,
    /// Reason why the law cannot be run at all; absent if it runs.
    pub refused: Option<String>,
    /// Results on every device.
    pub cells: Vec<Cell>,
    /// Worst value of each measure over all devices; absent if the law cannot be run.
    pub worst: Option<Figures>,
    /// Whether every measure on every device is within its limit.
    pub passes: bool,
    /// Sentences that say where the law fails, the worst measure first.
    pub fails: Vec<String>,
}

/// The results of all control laws in one scene.
#[derive(Debug, Clone, Serialize)]
pub struct Scorecard {
    /// Name of the scene.
    pub scene: String,
    /// Requested stiffness `k_de`, N·m/rad.
    pub k_desired: f64,
    /// Stiffness of the wall as the angle in rad by which the device's oscillation on the wall advances per control period.
    pub stiffness_per_tick: f64,
    /// The spring-damper from whose torque ripple the limit for the ripple of all laws is computed.
    pub reference: Reference,
    /// Measures of touches of an ideal damped wall and of an undamped spring, each divided by those of the ideal damped wall.
    /// Nominal device, the worst of three simulated grips (light, medium, firm).
    pub ideal_touch: Option<[TouchRatios; 2]>,
    /// Names of the devices on which a wall of this stiffness need not work.
    pub not_asked: Vec<&'static str>,
    /// Results of each control law.
    pub rows: Vec<Row>,
    /// Sentences that say which limits each spring with damping exceeds, and in which measures it is better or worse than each
    /// other law.
    pub damped_spring: Vec<String>,
}

/// Stiffness of a scene's wall as the angle in rad by which the device's oscillation on the wall advances per control period.
#[must_use]
pub fn stiffness_per_tick(scene: &Scene) -> f64 {
    (scene.wall.k_desired_n_m_per_rad / scene.device.inertia_kg_m2).sqrt() * scene.timing.period_s()
}

/// The devices on which a wall of this scene's stiffness must work.
pub fn asked(scene: &Scene) -> impl Iterator<Item = &'static Case> {
    let stiffness = stiffness_per_tick(scene);
    CASES.iter().filter(move |case| case.is_asked(stiffness))
}

/// Measures of the scene's law on one device, the worst of three simulated grips (light, medium, firm). `fully` adds the measures
/// without a limit.
///
/// # Errors
/// The control law does not accept its settings.
pub fn figures(
    scene: &Scene,
    programme: &Programme,
    case: &Case,
    fully: bool,
) -> Result<(Figures, Beside)> {
    let changed = case.of(scene);
    let ideal = fully
        .then(|| IdealTouch::of(&changed, programme))
        .transpose()?;
    let mut worst = Figures::NONE;
    let mut beside: Option<Beside> = None;
    let mut energy_j = 0.0_f64;
    for (index, grip) in GRIPS.into_iter().enumerate() {
        for deed in programme.deeds() {
            let of_deed = programme.scene(&changed, grip, deed);
            let (figures, mut next) = watch::watch(&of_deed, deed, fully)?;
            worst = worst.worst(&figures);
            energy_j = energy_j.max(next.energy_out_worst_window_j);
            if deed == Deed::Press {
                next.touch = ideal.as_ref().map(|ideal| ideal.ratios(index, &next));
                beside = Some(beside.map_or(next, |before| before.worst(&next)));
            }
        }
    }
    let mut beside = beside.unwrap_or_default();
    beside.energy_out_worst_window_j = energy_j;
    Ok((worst, beside))
}

/// Measures of touches of the ideal damped wall and of the undamped spring.
fn ideal_touch(scene: &Scene) -> Result<[TouchRatios; 2]> {
    let programme = Programme::of(scene);
    let ideal = IdealTouch::of(scene, &programme)?;
    Ok([
        ideal.with_ratio(scene, &programme, touch::DAMPING_RATIO)?,
        ideal.with_ratio(scene, &programme, 0.0)?,
    ])
}

/// Results of a scene's control law on all devices.
fn row(scene: &Scene, rival: &Rival, tuned: bool, reference: &Reference) -> Row {
    let programme = Programme::of(scene);
    let cases: Vec<&Case> = asked(scene).collect();
    let cells: Result<Vec<Cell>> = cases
        .par_iter()
        .map(|case| {
            let (figures, beside) = figures(scene, &programme, case, true)?;
            Ok(Cell::new(case, figures, beside, reference.limits(case)))
        })
        .collect();
    let (cells, refused) = match cells {
        Ok(cells) => (cells, None),
        Err(error) => (Vec::new(), Some(error.to_string())),
    };
    let worst = (!cells.is_empty()).then(|| {
        cells
            .iter()
            .fold(Figures::NONE, |worst, cell| worst.worst(&cell.figures))
    });
    Row {
        law: rival.name,
        about: rival.about,
        source: rival.source,
        tuned,
        damped_spring: rival.damped_spring,
        passes: refused.is_none() && cells.iter().all(Cell::passes),
        fails: words::fails(&cells),
        refused,
        cells,
        worst,
    }
}

/// A control law for the scorecard, with the scene that has its settings.
#[derive(Debug, Clone)]
pub struct Entry {
    /// The control law, as the scorecard lists it.
    pub rival: &'static Rival,
    /// The scene with this law and its settings.
    pub scene: Scene,
    /// Whether the settings were tuned for the device.
    pub tuned: bool,
}

/// Makes the scorecard of a scene for several laws; calls `done` with a law's name when the law is finished.
///
/// # Errors
/// The reference spring-damper cannot run in the scene. A law that refuses the scene is no error; its results say so.
pub fn scorecard(scene: &Scene, entries: &[Entry], done: impl FnMut(&str)) -> Result<Scorecard> {
    let reference = Reference::of(scene)?;
    Ok(with_reference(scene, entries, reference, done))
}

/// Makes the scorecard of a scene for several laws, with a known reference spring-damper for the limit of the ripple. Calls `done`
/// with a law's name when the law is finished.
pub fn with_reference(
    scene: &Scene,
    entries: &[Entry],
    reference: Reference,
    mut done: impl FnMut(&str),
) -> Scorecard {
    let stiffness = stiffness_per_tick(scene);
    let rows: Vec<Row> = entries
        .iter()
        .map(|entry| {
            let row = row(&entry.scene, entry.rival, entry.tuned, &reference);
            done(row.law);
            row
        })
        .collect();
    Scorecard {
        scene: scene.name.clone(),
        k_desired: scene.wall.k_desired_n_m_per_rad,
        stiffness_per_tick: stiffness,
        reference,
        ideal_touch: ideal_touch(scene).ok(),
        not_asked: CASES
            .iter()
            .filter(|case| !case.is_asked(stiffness))
            .map(|case| case.name)
            .collect(),
        damped_spring: words::damped_spring(&rows),
        rows,
    }
}
