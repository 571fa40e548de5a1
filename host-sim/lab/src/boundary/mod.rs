//! Where a tuned wall ends, over the device's damping and its delay: is the limit inertia or damping?
//!
//! A sampled wall has two measures of its own: `T sqrt(k_de/J)`, the angle by which a free device on the wall turns in a tick, and
//! `b T/J`, the share of its speed that the device loses in one. Damping limits a spring at `k_c = b/(T/2 + t_d)`, which is a line of
//! slope one half over these two; what inertia limits is a level one. Each cell of the plane is a device and a wall. Its law has the settings
//! at which the matrices are best or, where these do not hold, settings that a search by runs finds. Its press and its moving hand are run,
//! and [`certify`] is asked beside. [`map`] draws it.

pub mod map;
#[cfg(test)]
mod tests;

use crate::certify;
use crate::journal::Journal;
use crate::random_device::FINGERTIP;
use crate::report::origin::sha256;
use crate::scorecard::cases::Programme;
use crate::scorecard::rivals::Rival;
use crate::tune::diagnosis::{self, FailureCause};
use crate::tune::{self, outcome::Outcome};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::path::Path;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::{Encoder, MotionSpec, Scene};

/// Least and largest `b T/J`.
pub const DAMPINGS: [f64; 2] = [1e-4, 1.0];
/// Least and largest `T sqrt(k_de/J)`.
pub const STIFFNESSES: [f64; 2] = [0.1, 2.0];
/// Least depth of a press in counts: of a shallower one nothing but rounding is seen.
const DEEP_COUNTS: f64 = 20.0;
/// Cells between two writes.
const CELLS_A_WRITE: usize = 8;

/// The plane to compute.
#[derive(Debug, Clone)]
pub struct BoundaryPlan {
    /// Inertia, rate, encoder, friction and press; damping, delay and stiffness are those of the cells.
    pub base: Scene,
    /// The law that is tuned for every cell.
    pub rival: &'static Rival,
    /// `b T/J` of the columns.
    pub dampings: Vec<f64>,
    /// `T sqrt(k_de/J)` of the rows.
    pub stiffnesses: Vec<f64>,
    /// Delays, ticks: a panel each.
    pub delays: Vec<f64>,
    /// How long a search may look at a cell, simulated ticks.
    pub ticks: f64,
    /// Seed of the searches.
    pub seed: u64,
}

/// One place of the plane.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct BoundaryPlace {
    /// Delay, ticks.
    pub delay_ticks: f64,
    /// Damping per tick: `b T/J`.
    pub damping_per_tick: f64,
    /// `T sqrt(k_de/J)`.
    pub stiffness_per_tick: f64,
}

/// What became of the tuned wall, the worst of three grips. The order is from good to bad.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TunedEnding {
    /// Rests within 5 % of `k_de`, and a moving hand feels it within 15 % and 15° up to 4 Hz.
    Holds,
    /// Rests within 5 %; a moving hand feels another stiffness.
    Rests,
    /// Rests at another stiffness.
    RestsElsewhere,
    /// The wall does not come to rest.
    DoesNotRest,
    /// The law has no settings for such a wall.
    Refused,
}

impl TunedEnding {
    /// All endings.
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

/// One cell that was computed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BoundaryCell {
    /// A digest of scene, law, budget and seed, to which the cell belongs.
    pub plan: String,
    /// Delay, ticks.
    pub delay_ticks: f64,
    /// Damping per tick: `b T/J`.
    pub damping_per_tick: f64,
    /// `T sqrt(k_de/J)`.
    pub stiffness_per_tick: f64,
    /// Damping of the device, N·m·s/rad.
    pub damping_n_m_s_per_rad: f64,
    /// `k_de`, N·m/rad.
    pub k_desired: f64,
    /// `k_de` over `b/(T/2 + t_d)`, which the device's own damping makes passive.
    pub times_critical: f64,
    /// How the run ended.
    pub ended: TunedEnding,
    /// Largest deviation at rest, share; `NaN` in the table where a press does not rest.
    #[serde(with = "crate::journal::or_nan")]
    pub displayed_error: Option<f64>,
    /// Deviation of the modulus of a hand that moves, share; `NaN` where the wall was left.
    #[serde(with = "crate::journal::or_nan")]
    pub modulus_error: Option<f64>,
    /// Phase of the moving hand, degrees.
    #[serde(with = "crate::journal::or_nan")]
    pub phase_deg: Option<f64>,
    /// What `certify` says of the three grips.
    pub certificate: Option<certify::Verdict>,
    /// Why, in its words.
    pub certificate_causes: String,
    /// Why a press does not rest at `k_de`; empty where it does.
    pub rest_cause: Option<FailureCause>,
    /// Settings that were run; none beyond those of the matrices: 1.
    pub looks: u64,
}

impl BoundaryCell {
    /// Whether the certificate of the cell is "stable".
    #[must_use]
    pub fn is_certified(&self) -> bool {
        self.certificate == Some(certify::Verdict::Stable)
    }

    /// Whether it says so of a wall that does not come to rest.
    #[must_use]
    pub fn is_wrongly_stable(&self) -> bool {
        self.is_certified() && self.ended == TunedEnding::DoesNotRest
    }
}

/// This many values from `from` to `to` in even ratios, rounded to four digits, so that the written values are those
/// that run.
fn even_ratios([from, to]: [f64; 2], count: usize) -> Vec<f64> {
    (0..count)
        .map(|index| {
            let share = index as f64 / (count.max(2) - 1) as f64;
            tune::parameters::rounded(from * (to / from).powf(share))
        })
        .collect()
}

impl BoundaryPlan {
    /// A plane of this many columns and rows.
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

    /// Every place, panel by panel, column by column, from soft to stiff.
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

    /// Device and wall of a place. The press is the scene's, or strong enough for twenty counts of depth. The limits
    /// of torque and force grow with it, since the map is not about them.
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

    /// Tunes, runs and certifies a cell.
    ///
    /// # Errors
    /// A scene that no law can run in.
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
        let said = tune::campaign::certificate(&tuned).ok();
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
            k_desired,
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

    /// Twelve digits that differ where cells would.
    fn digest(&self) -> String {
        let of = format!(
            "{} {} {} {} {}",
            self.base.to_toml(),
            self.rival.name,
            self.ticks,
            self.seed,
            env!("CARGO_PKG_VERSION")
        );
        sha256(of.as_bytes())[..12].to_owned()
    }

    /// Computes every cell that a file does not have yet; `told` gets the number of finished cells.
    ///
    /// # Errors
    /// A file that holds the cells of another plane, or cannot be written.
    pub fn fill(&self, file: &Path, mut told: impl FnMut(u64)) -> Result<Vec<BoundaryCell>> {
        let (mut journal, mut cells) = Journal::open::<BoundaryCell>(file)?;
        let digest = self.digest();
        if cells.iter().any(|cell| cell.plan != digest) {
            return Err(Error::Io {
                path: file.to_owned(),
                problem: "holds cells of another scene, law, budget or seed".to_owned(),
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
        // Those of this plane, in its own order: a file may hold a finer one.
        Ok(places
            .iter()
            .filter_map(|place| cells.iter().find(|cell| is_at(cell, place)).cloned())
            .collect())
    }
}

/// How far up a column goes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ColumnLimits {
    /// Delay, ticks.
    pub delay_ticks: f64,
    /// Damping per tick: `b T/J`.
    pub damping_per_tick: f64,
    /// Largest `T sqrt(k_de/J)` up to which every wall rests within 5 %; absent where the softest does not.
    pub rests_up_to: Option<f64>,
    /// The largest at which one does.
    pub highest_at_rest: Option<f64>,
    /// The limit of stiffness with a moving hand as well.
    pub holds_up_to: Option<f64>,
    /// The largest at or below the first of which `certify` says stable.
    pub certified_up_to: Option<f64>,
    /// `k_de` at the first limit, over the stiffness that the device's own damping makes passive.
    pub times_critical: Option<f64>,
}

/// The limits of every column.
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

/// Slope of the boundary of a delay over the damping, both logarithmic: 0 where inertia is the limit, 0.5 where damping is. Of columns up
/// to a damping of `most` of which a wall rests, one that rests to its top with that; absent where fewer than two are left.
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
