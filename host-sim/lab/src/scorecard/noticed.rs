//! Finds in the recorded ticks of a device when a person's hand rested, oscillated, and left the wall.

use super::in_turn::DeedsInTurn;
use super::measure::{Figures, Measure};
use super::press::DesiredStiffness;
use super::rhythm::rhythms;
use super::touched::{RESTING_COUNTS, TouchedSeries, TouchedTick, resting};
use serde::Serialize;
use std::ops::Range;
use touchstone_sim::run::measure::{RateHardness, Release, Response, Ripple};

/// A recorded run on a haptic device, with the settings of its wall.
#[derive(Debug, Clone, Copy)]
pub struct DeviceRun<'a> {
    /// All recorded ticks (control periods) of the run.
    pub ticks: &'a [TouchedTick],
    /// Control rate, Hz.
    pub rate_hz: u32,
    /// Requested stiffness of the wall, with the uncertainty of a depth.
    pub stiffness: DesiredStiffness,
    /// First tick with the full force; before it the force is faded in.
    pub whole_from: u64,
    /// Whether commands act at least half a control period late.
    pub late: bool,
    /// The simulated hand's actions; `None` if a person moved the device.
    pub turn: Option<DeedsInTurn>,
}

/// Response of the wall at one frequency of the hand. Of several stretches of time, the values that deviate most count: the
/// modulus furthest from the requested stiffness, and the phase of largest magnitude.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MovedAt {
    /// Frequency of the hand's motion, Hz.
    pub frequency_hz: f64,
    /// Amplitude of the force over that of the penetration, N/m; absent if the hand left the wall.
    pub modulus_n_per_m: Option<f64>,
    /// Phase by which the force leads the penetration, degrees; absent if the hand left the wall.
    pub phase_deg: Option<f64>,
    /// Number of separate stretches of time in which the hand moved at this frequency.
    pub stretches: usize,
}

/// Shortest rest or contact that is evaluated, s.
const STRETCH_S: f64 = 0.25;
/// Time before and after the hand leaves the surface in which the largest speed is searched, s.
const LEAVING_S: f64 = 0.2;
/// Time over which a speed is averaged, s. Over this time, one position count of 0.01 mm makes a speed of one millimetre per
/// second.
pub(super) const SPEED_S: f64 = 0.01;

pub(super) fn met(response: &Response, frequency_hz: f64) -> MovedAt {
    let stiffness = response.stiffness();
    MovedAt {
        frequency_hz,
        modulus_n_per_m: stiffness.map(|it| it.modulus_n_m_per_rad),
        phase_deg: stiffness.map(|it| it.phase_deg),
        stretches: 1,
    }
}

/// Frequencies that differ by at most this fraction count as the same.
const SAME_FREQUENCY: f64 = 0.05;

/// Adds the response during one stretch of time to the entry of its frequency.
fn join(moved: &mut Vec<MovedAt>, next: MovedAt, k_desired: f64) {
    let same =
        |at: &&mut MovedAt| (at.frequency_hz / next.frequency_hz - 1.0).abs() <= SAME_FREQUENCY;
    let Some(at) = moved.iter_mut().find(same) else {
        moved.push(next);
        return;
    };
    at.stretches += 1;
    // If the hand left the wall once, there is no value, which counts as the worst.
    at.modulus_n_per_m = at.modulus_n_per_m.zip(next.modulus_n_per_m).map(|(a, b)| {
        match (a - k_desired).abs() < (b - k_desired).abs() {
            true => b,
            false => a,
        }
    });
    at.phase_deg = at
        .phase_deg
        .zip(next.phase_deg)
        .map(|(a, b)| match a.abs() < b.abs() {
            true => b,
            false => a,
        });
}

/// Measures from the motion of a person's hand; a missing value was not measured.
pub(super) struct Noticed {
    pub(super) moment: Option<f64>,
    pub(super) held: Option<f64>,
    pub(super) rest_counts: Option<f64>,
    pub(super) modulus: Option<f64>,
    pub(super) phase: Option<f64>,
    pub(super) ripple: Option<f64>,
    pub(super) leaving: Option<f64>,
    pub(super) hardness: Option<f64>,
    pub(super) moved: Vec<MovedAt>,
}

fn largest(values: impl Iterator<Item = f64>) -> Option<f64> {
    values.reduce(f64::max)
}

impl Noticed {
    pub(super) fn at(run: &DeviceRun, series: &TouchedSeries) -> Self {
        let rate_hz = f64::from(run.rate_hz);
        let ticks = |seconds: f64| (seconds * rate_hz).round().max(1.0) as usize;
        let (from, stiffness) = (series.index(run.whole_from), &run.stiffness);
        let contacts = series.contacts(from, stiffness, ticks(STRETCH_S));
        let off = |i: usize| stiffness.off(series.middle[i], series.out[i]);
        let rests: Vec<Range<usize>> = contacts
            .iter()
            .flat_map(|at| resting(&series.depth, at, ticks(STRETCH_S), stiffness.count))
            .collect();
        let motion = |at: &Range<usize>| {
            let part = series.depth[at.clone()].iter().copied();
            part.clone().fold(f64::NEG_INFINITY, f64::max) - part.fold(f64::INFINITY, f64::min)
        };
        let mut figures = Figures::NONE;
        let mut moved = Vec::new();
        for contact in &contacts {
            let least = RESTING_COUNTS * stiffness.count;
            let depth = &series.middle[contact.clone()];
            for wiggle in rhythms(depth, contact.start as u64, rate_hz, least) {
                let mut response = Response::new(wiggle, 1.0 / rate_hz);
                for i in wiggle.window.0 as usize..wiggle.window.1 as usize {
                    response.record(i as u64, series.middle[i], series.out[i]);
                }
                figures.raise_moved(&response, stiffness.k_desired);
                let next = met(&response, wiggle.frequency_hz);
                join(&mut moved, next, stiffness.k_desired);
            }
        }
        let ripple = contacts.iter().max_by_key(|at| at.len()).and_then(|at| {
            let mut ripple = Ripple::new((at.start as u64, at.end as u64), rate_hz);
            for i in at.clone() {
                ripple.record(i as u64, series.out[i]);
            }
            ripple.tick_to_tick_rms_n_m()
        });
        let intervals = ticks(SPEED_S);
        let leaving = contacts
            .iter()
            .filter(|at| at.end < series.out.len())
            .map(|at| {
                let mut release = Release::new(0);
                let around = at.end.saturating_sub(ticks(LEAVING_S)).max(at.start)
                    ..(at.end + ticks(LEAVING_S)).min(series.out.len());
                for i in around {
                    let speed = series.speed(i, intervals, rate_hz);
                    release.record(i as u64, series.depth[i], speed);
                }
                release.speed_rad_per_s()
            });
        let mut hardness = RateHardness::new(1.0 / rate_hz);
        // A contact that began before the force was fully faded in has no usable beginning.
        let free = (from..series.out.len()).find(|i| series.out[*i] <= 0.0);
        for i in free.unwrap_or(series.out.len())..series.out.len() {
            hardness.record(series.depth[i], series.out[i]);
        }
        let seen = |value: f64| (!moved.is_empty()).then_some(value);
        Self {
            moment: largest((from..series.out.len()).filter_map(off)),
            held: largest(rests.iter().cloned().flatten().filter_map(off)),
            rest_counts: largest(rests.iter().map(|at| motion(at) / stiffness.count)),
            modulus: seen(figures.get(Measure::ModulusError)),
            phase: seen(figures.get(Measure::PhaseDeg)),
            ripple,
            leaving: largest(leaving),
            hardness: hardness.n_m_per_rad(),
            moved,
        }
    }
}
