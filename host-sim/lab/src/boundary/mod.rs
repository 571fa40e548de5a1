//! Maps where a tuned wall stops working, depending on the device's damping and delay, to answer whether inertia or damping sets
//! the limit.
//!
//! A sampled wall has two dimensionless measures. `T` is the control period, `k_de` the requested stiffness, `J` and `b` are
//! inertia and damping of the device. `T sqrt(k_de/J)` is the angle in rad by which the oscillation of a free device on the wall
//! advances per period. `b T/J` is the fraction of its speed that the device loses per period. Damping limits a spring at
//! `b/(T/2 + t_d)` with the delay `t_d`. On logarithmic axes of the measures this limit is a line of slope 1/2; a limit set by
//! inertia is horizontal.
//!
//! Each cell of the map is a device and a wall. First the law gets the settings with the best eigenvalues of the loop. If this wall
//! does not hold, a search by simulated runs tunes the settings. Then a press and a moving hand are simulated, and [`certify`]
//! judges the same wall. [`map`] draws the results.

pub mod map;
#[cfg(test)]
mod tests;

use crate::certify;
use crate::journal::Journal;
use crate::random_device::FINGERTIP;
use crate::scorecard::cases::Programme;
use crate::scorecard::rivals::Rival;
use crate::tune::diagnosis::{self, FailureCause};
use crate::tune::{self, outcome::Outcome};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::path::Path;
use touchstone_report::origin::sha256;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::{Encoder, MotionSpec, Scene};

/// Range of `b T/J` in the map: fraction of its speed that the free device loses per control period `T` (damping `b`, inertia `J`).
pub const DAMPINGS: [f64; 2] = [1e-4, 1.0];
/// Range of `T sqrt(k_de/J)` in the map, rad: advance of the oscillation on a wall `k_de` per control period `T` (inertia `J`).
pub const STIFFNESSES: [f64; 2] = [0.1, 2.0];
/// Least depth of a press in encoder counts. In a shallower press, rounding to counts would hide the wall's behaviour.
const DEEP_COUNTS: f64 = 20.0;
/// Number of cells that are computed between two writes to the file.
const CELLS_A_WRITE: usize = 8;

/// Plan of a map: its base scene, control law, axes and search length.
#[derive(Debug, Clone)]
pub struct BoundaryPlan {
    /// Scene that gives inertia, rate, encoder, friction and press. Damping, delay and stiffness come from each cell.
    pub base: Scene,
    /// The control law that is tuned for every cell.
    pub rival: &'static Rival,
    /// Damping of each column of the map, as the fraction of its speed that the free device loses per control period.
    pub dampings: Vec<f64>,
    /// Stiffness of each row of the map, as the angle in rad by which the oscillation on the wall advances per control period.
    pub stiffnesses: Vec<f64>,
    /// Delays from sample to force, in control periods; the map has one panel for each.
    pub delays: Vec<f64>,
    /// Largest number of ticks (control periods) that the search may simulate per cell.
    pub ticks: f64,
    /// Seed of the searches' random numbers.
    pub seed: u64,
}

/// Position of a cell in the map.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BoundaryPlace {
    /// Delay from sample to force, in ticks (control periods).
    pub delay_ticks: f64,
    /// Damping as the fraction of its speed that the free device loses per control period.
    pub damping_per_tick: f64,
    /// Stiffness as the angle in rad by which the oscillation on the wall advances per control period.
    pub stiffness_per_tick: f64,
}

/// How the tuned wall behaves, in the worst of three simulated grips (light, medium, firm); ordered from good to bad.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TunedEnding {
    /// The knob rests at a stiffness within 5 % of the requested one. For a hand moving at up to 4 Hz, force over penetration is
    /// within 15 % and 15° of the requested stiffness.
    Holds,
    /// The knob rests at a stiffness within 5 % of the requested one, but a moving hand meets a stiffness outside the limits of
    /// `Holds`.
    Rests,
    /// The knob rests, but at a stiffness more than 5 % off the requested one.
    RestsElsewhere,
    /// The knob does not come to rest in the wall.
    DoesNotRest,
    /// The control law has no settings for such a wall.
    Refused,
}

impl TunedEnding {
    /// All ways in which a tuned wall may behave, from good to bad.
    pub const ALL: [TunedEnding; 5] = [
        TunedEnding::Holds,
        TunedEnding::Rests,
        TunedEnding::RestsElsewhere,
        TunedEnding::DoesNotRest,
        TunedEnding::Refused,
    ];

    fn of(outcome: &Outcome) -> Self {
        match (outcome.rests(), outcome.moves(), outcome.ends_at_rest()) {
            (true, true, _) => TunedEnding::Holds,
            (true, false, _) => TunedEnding::Rests,
            (false, _, true) => TunedEnding::RestsElsewhere,
            (false, _, false) => TunedEnding::DoesNotRest,
        }
    }
}

/// Results of one cell of the map: a device and a wall.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BoundaryCell {
    /// Digest of scene, law, search length, seed and program version. Cells with different digests belong to different maps.
    pub plan: String,
    /// Delay from sample to force, in ticks (control periods).
    pub delay_ticks: f64,
    /// Damping as the fraction of its speed that the free device loses per control period.
    pub damping_per_tick: f64,
    /// Stiffness as the angle in rad by which the oscillation on the wall advances per control period.
    pub stiffness_per_tick: f64,
    /// Viscous damping of the device, N·m·s/rad.
    pub damping_n_m_s_per_rad: f64,
    /// Requested stiffness `k_de`, N·m/rad.
    pub k_desired_n_m_per_rad: f64,
    /// Requested stiffness divided by the largest stiffness that the device's own damping makes passive, `b/(T/2 + t_d)`. `b` is
    /// the damping, `T` the control period, `t_d` the delay.
    pub times_critical: f64,
    /// How the tuned wall behaves in the worst of three simulated grips (light, medium, firm).
    pub ended: TunedEnding,
    /// Largest relative deviation of the stiffness at rest from the requested one; `NaN` in the file if a press does not come to
    /// rest or the law has no settings.
    #[serde(with = "crate::journal::or_nan")]
    pub displayed_error: Option<f64>,
    /// Relative deviation of force over penetration from the requested stiffness for a moving hand; `NaN` in the file if the knob
    /// left the wall or the law has no settings.
    #[serde(with = "crate::journal::or_nan")]
    pub modulus_error: Option<f64>,
    /// Phase of force over penetration for a moving hand, degrees.
    #[serde(with = "crate::journal::or_nan")]
    pub phase_deg: Option<f64>,
    /// Worst verdict of the stability certificate over the three simulated grips (light, medium, firm).
    pub certificate: Option<certify::Verdict>,
    /// Reasons that the certificate gives for its verdict.
    pub certificate_causes: String,
    /// Cause why a press does not rest at the requested stiffness; empty if it does, or if the law has no settings.
    pub rest_cause: Option<FailureCause>,
    /// Number of settings that were simulated: 1 if the wall holds with the settings of the best eigenvalues.
    pub looks: u64,
}

impl BoundaryCell {
    /// Whether the certificate says that the wall is stable.
    #[must_use]
    pub fn is_certified(&self) -> bool {
        self.certificate == Some(certify::Verdict::Stable)
    }

    /// Whether the certificate says "stable" although the wall does not come to rest.
    #[must_use]
    pub fn is_wrongly_stable(&self) -> bool {
        self.is_certified() && self.ended == TunedEnding::DoesNotRest
    }
}

/// Returns `count` values from `from` to `to`, evenly spaced on a logarithmic scale. The values are rounded to four digits, so that
/// simulated values and values in the file agree.
fn even_ratios([from, to]: [f64; 2], count: usize) -> Vec<f64> {
    (0..count)
        .map(|index| {
            let share = index as f64 / (count.max(2) - 1) as f64;
            tune::parameters::rounded(from * (to / from).powf(share))
        })
        .collect()
}

impl BoundaryPlan {
    /// Plans a map with the given numbers of columns (damping) and rows (stiffness), at delays of 0, 0.5 and 1 tick.
    #[must_use]
    pub fn new(base: Scene, rival: &'static Rival, [columns, rows]: [usize; 2]) -> Self {
        Self {
            base,
            rival,
            dampings: even_ratios(DAMPINGS, columns),
            stiffnesses: even_ratios(STIFFNESSES, rows),
            delays: vec![0.0, 0.5, 1.0],
            ticks: 1e6,
            seed: 1,
        }
    }

    /// All positions in the map: panel by panel, column by column, from soft to stiff.
    #[must_use]
    pub fn places(&self) -> Vec<BoundaryPlace> {
        let mut places = Vec::new();
        for &delay_ticks in &self.delays {
            for &damping_per_tick in &self.dampings {
                places.extend(
                    self.stiffnesses
                        .iter()
                        .map(|&stiffness_per_tick| BoundaryPlace {
                            delay_ticks,
                            damping_per_tick,
                            stiffness_per_tick,
                        }),
                );
            }
        }
        places
    }

    /// Scene with the device and the wall of a position in the map. The press is the scene's, or stronger if it would go less than
    /// twenty encoder counts deep. The limits of torque and force grow with the press, because they are not the subject of the map.
    #[must_use]
    pub fn scene(&self, place: BoundaryPlace) -> Scene {
        let mut scene = self.base.clone();
        let period_s = scene.timing.period_s();
        let inertia = scene.device.inertia_kg_m2;
        let stiffness = inertia * (place.stiffness_per_tick / period_s).powi(2);
        scene.device.damping_n_m_s_per_rad = place.damping_per_tick * inertia / period_s;
        scene.timing.computational_delay_s = place.delay_ticks * period_s;
        scene.wall.k_desired_n_m_per_rad = stiffness;
        scene.law.device_damping_n_m_s_per_rad = scene.device.damping_n_m_s_per_rad + FINGERTIP;
        let mut press = Programme::of(&scene).press;
        let count = scene.encoder.as_ref().map_or(0.0, Encoder::step_rad);
        let stronger = (DEEP_COUNTS * count * stiffness / press.push_torque_n_m).max(1.0);
        press.push_torque_n_m *= stronger;
        press.touch_torque_n_m *= stronger;
        scene.operator.motion = MotionSpec::TouchAndPress(press);
        scene.law.force_limit_n_m = (scene.law.force_limit_n_m * stronger).min(100.0);
        if let Some(limit) = &mut scene.device.torque_limit_n_m {
            *limit *= stronger;
        }
        scene
    }

    /// Tunes, simulates and certifies the wall at one position of the map.
    ///
    /// # Errors
    /// The control law cannot run in the scene.
    pub fn cell(&self, place: BoundaryPlace) -> Result<BoundaryCell> {
        let scene = self.scene(place);
        let (period_s, b) = (scene.timing.period_s(), scene.device.damping_n_m_s_per_rad);
        let late_s = 0.5 * period_s + scene.timing.computational_delay_s;
        let k_desired = scene.wall.k_desired_n_m_per_rad;
        let mut tuned = tune::by_matrices(&scene, self.rival, self.seed);
        let mut looks = 1;
        let mut outcome = Outcome::of(&tuned).ok();
        if !outcome.as_ref().is_some_and(Outcome::holds) {
            let found = tune::to_rest(&scene, self.rival, self.ticks, self.seed);
            looks += found.evaluations;
            let other = Outcome::of(&found.scene).ok();
            let rank = |of: &Outcome| TunedEnding::of(of);
            let is_better = match (&other, &outcome) {
                (Some(other), Some(before)) => rank(other) < rank(before),
                (other, _) => other.is_some(),
            };
            if is_better {
                (tuned, outcome) = (found.scene, other);
            }
        }
        let said = tune::diagnosis::certificate(&tuned).ok();
        let rest_cause = outcome.as_ref().zip(said.as_ref()).and_then(|(it, said)| {
            let fails = |it: &Outcome| !it.rests();
            fails(it).then(|| diagnosis::cause(&tuned, it, said.verdict, fails))
        });
        Ok(BoundaryCell {
            plan: self.digest(),
            delay_ticks: place.delay_ticks,
            damping_per_tick: place.damping_per_tick,
            stiffness_per_tick: place.stiffness_per_tick,
            damping_n_m_s_per_rad: b,
            k_desired_n_m_per_rad: k_desired,
            times_critical: k_desired * late_s / b,
            ended: outcome
                .as_ref()
                .map_or(TunedEnding::Refused, TunedEnding::of),
            displayed_error: outcome.as_ref().and_then(|it| it.displayed_error),
            modulus_error: outcome.as_ref().and_then(|it| it.modulus_error),
            phase_deg: outcome.as_ref().and_then(|it| it.phase_deg),
            certificate: said.as_ref().map(|said| said.verdict),
            certificate_causes: said
                .as_ref()
                .map_or_else(String::new, |said| said.hands[said.worst].causes.join("; ")),
            rest_cause,
            looks,
        })
    }

    /// First twelve characters of a hash over all values on which the results of a cell depend.
    fn digest(&self) -> String {
        let of = format!(
            "{} {} {} {} {}",
            self.base.to_toml(),
            self.rival.name,
            self.ticks,
            self.seed,
            env!("CARGO_PKG_VERSION")
        );
        // Without the prefix, programs that read the table would take some digests for numbers: 150000000000, 12e345678901.
        format!("plan-{}", &sha256(of.as_bytes())[..12])
    }

    /// Computes every cell that the file does not contain yet, and appends it to the file. Calls `told` with the number of finished
    /// cells.
    ///
    /// # Errors
    /// The file holds the cells of another map, or cannot be written.
    pub fn fill(&self, file: &Path, mut told: impl FnMut(u64)) -> Result<Vec<BoundaryCell>> {
        let (mut journal, mut cells) = Journal::open::<BoundaryCell>(file)?;
        let digest = self.digest();
        if cells.iter().any(|cell| cell.plan != digest) {
            return Err(Error::Io {
                path: file.to_owned(),
                problem: "contains cells of another scene, law, search length or seed".to_owned(),
                fix: "give --out another folder, or remove the file".to_owned(),
            });
        }
        let is_at = |cell: &BoundaryCell, place: &BoundaryPlace| {
            cell.delay_ticks == place.delay_ticks
                && cell.damping_per_tick == place.damping_per_tick
                && cell.stiffness_per_tick == place.stiffness_per_tick
        };
        let places = self.places();
        let todo: Vec<BoundaryPlace> = places
            .iter()
            .copied()
            .filter(|place| !cells.iter().any(|cell| is_at(cell, place)))
            .collect();
        let before = (places.len() - todo.len()) as u64;
        told(before);
        for (index, piece) in todo.chunks(CELLS_A_WRITE).enumerate() {
            let done: Vec<BoundaryCell> = piece
                .par_iter()
                .map(|place| self.cell(*place))
                .collect::<Result<_>>()?;
            journal.append(None, &done)?;
            cells.extend(done);
            told(before + (index * CELLS_A_WRITE + piece.len()) as u64);
        }
        // Returns only the cells of this map, in the map's order; the file may also have cells of a finer map.
        Ok(places
            .iter()
            .filter_map(|place| cells.iter().find(|cell| is_at(cell, place)).cloned())
            .collect())
    }
}

/// Largest stiffnesses of one column of the map, which has one damping and one delay. Stiffness is the angle in rad by which the
/// oscillation on the wall advances per control period.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ColumnLimits {
    /// Delay from sample to force, in ticks (control periods).
    pub delay_ticks: f64,
    /// Damping as the fraction of its speed that the free device loses per control period.
    pub damping_per_tick: f64,
    /// Largest stiffness (rad per control period) up to which every wall rests within 5 % of the requested stiffness. Absent if the
    /// softest wall does not.
    pub rests_up_to: Option<f64>,
    /// Largest stiffness (rad per control period) at which a wall rests within 5 % of the requested stiffness, even if a softer
    /// wall does not.
    pub highest_at_rest: Option<f64>,
    /// Largest stiffness (rad per control period) up to which every wall rests and also has the requested stiffness for a moving
    /// hand.
    pub holds_up_to: Option<f64>,
    /// Largest stiffness (rad per control period), at most `rests_up_to`, whose wall is certified stable.
    pub certified_up_to: Option<f64>,
    /// Stiffness of the wall at `rests_up_to`, divided by the stiffness that the device's own damping makes passive.
    pub times_critical: Option<f64>,
}

/// Calculates the largest stiffnesses of every column of the map.
#[must_use]
pub fn limits(plan: &BoundaryPlan, cells: &[BoundaryCell]) -> Vec<ColumnLimits> {
    let mut found = Vec::new();
    for &delay_ticks in &plan.delays {
        for &damping_per_tick in &plan.dampings {
            let column: Vec<&BoundaryCell> = cells
                .iter()
                .filter(|cell| {
                    cell.delay_ticks == delay_ticks && cell.damping_per_tick == damping_per_tick
                })
                .collect();
            let up_to = |is: &dyn Fn(&BoundaryCell) -> bool| {
                column.iter().copied().take_while(|cell| is(cell)).last()
            };
            let at_rest = |cell: &BoundaryCell| cell.ended <= TunedEnding::Rests;
            let stiffness = |cell: &BoundaryCell| cell.stiffness_per_tick;
            let rests = up_to(&at_rest);
            found.push(ColumnLimits {
                delay_ticks,
                damping_per_tick,
                rests_up_to: rests.map(stiffness),
                highest_at_rest: column
                    .iter()
                    .rev()
                    .find(|cell| at_rest(cell))
                    .map(|cell| stiffness(cell)),
                holds_up_to: up_to(&|cell| cell.ended == TunedEnding::Holds).map(stiffness),
                certified_up_to: column
                    .iter()
                    .rev()
                    .filter(|cell| rests.is_some_and(|top| stiffness(cell) <= stiffness(top)))
                    .find(|cell| cell.is_certified())
                    .map(|cell| stiffness(cell)),
                times_critical: rests.map(|cell| cell.times_critical),
            });
        }
    }
    found
}

/// Slope of the stiffness limit `rests_up_to` over the damping at one delay, on logarithmic axes. The slope is 0 if inertia sets
/// the limit, 0.5 if damping does.
///
/// Columns with a damping above `most`, or without a wall that rests, are left out; `None` if fewer than two remain.
#[must_use]
pub fn slope(limits: &[ColumnLimits], delay_ticks: f64, most: f64) -> Option<f64> {
    let points: Vec<(f64, f64)> = limits
        .iter()
        .filter(|it| it.delay_ticks == delay_ticks && it.damping_per_tick <= most)
        .filter_map(|it| Some((it.damping_per_tick.ln(), it.rests_up_to?.ln())))
        .collect();
    let count = points.len() as f64;
    if points.len() < 2 {
        return None;
    }
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(|point| point.0), mean(|point| point.1));
    let across: f64 = points.iter().map(|point| (point.0 - x).powi(2)).sum();
    let along: f64 = points
        .iter()
        .map(|point| (point.0 - x) * (point.1 - y))
        .sum();
    Some(along / across)
}
