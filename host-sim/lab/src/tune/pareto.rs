//! Shows the trade-off between stiffness, torque ripple and delay: settings of which none is better than another in all three.

use super::Tuned;
use super::cost::Judgement;
use super::parameters::rounded;
use crate::scorecard::cases::{Case, Change};
use crate::scorecard::measure::{Limits, Measure};
use rayon::prelude::*;
use serde::Serialize;
use touchstone_control::choices::{LawKind, StatesKind};
use touchstone_report::figure::{Axis, Figure, Range, Shape, Sign};
use touchstone_sim::scene::{Law, Scene};

/// Settings that keep every limit of the scorecard except that of the ripple on every simulated device, and their stiffness,
/// ripple and delay margin.
#[derive(Debug, Clone, Serialize)]
pub struct Point {
    /// Requested stiffness `k_de`, N·m/rad.
    pub k_desired: f64,
    /// Root mean square change of the torque from tick to tick on the nominal device while the hand oscillates, N·m.
    pub ripple_rms_n_m: f64,
    /// Longest delay with which the wall on the nominal device is within the limits, in ticks (control periods), to a sixteenth of
    /// a tick. The search ends at 3 ticks.
    pub delay_margin_ticks: f64,
    /// Bandwidth of the law's state estimator, Hz; absent if the law uses measured states.
    pub bandwidth_hz: Option<f64>,
    /// Whether no other point is at least as good in stiffness, ripple and delay and better in one of them.
    pub best: bool,
}

/// Stiffnesses that are tried, as factors on the requested stiffness.
const STIFFNESSES: [f64; 6] = [0.4, 0.6, 0.8, 1.0, 1.25, 1.6];
/// Bandwidths of the state estimator that are tried, as factors on the tuned bandwidth.
const BANDWIDTHS: [f64; 4] = [0.6, 0.8, 1.0, 1.3];
/// Dampings that are tried, as factors on the tuned damping.
const DAMPINGS: [f64; 4] = [0.5, 0.7, 1.0, 1.4];
/// Longest delay that is tried, in ticks (control periods).
const MOST_TICKS: f64 = 3.0;

/// The tuned law for a wall that is `stiffness` times as stiff, with additional factors on bandwidth and damping. Frequencies and
/// dampings scale with the square root of the stiffness, stiffnesses with the stiffness itself.
fn scaled(scene: &Scene, stiffness: f64, bandwidth: f64, damping: f64) -> Scene {
    let mut scene = scene.clone();
    scene.wall.k_desired_n_m_per_rad *= stiffness;
    let root = stiffness.sqrt();
    let rate = f64::from(scene.timing.rate_hz);
    let law: &mut Law = &mut scene.law;
    law.estimator.bandwidth_hz =
        rounded((law.estimator.bandwidth_hz * root * bandwidth).min(0.19 * rate));
    law.virtual_damping_n_m_s_per_rad = rounded(law.virtual_damping_n_m_s_per_rad * root * damping);
    law.filter.damping_n_m_s_per_rad = rounded(law.filter.damping_n_m_s_per_rad * root * damping);
    law.filter.ground_damping_n_m_s_per_rad =
        rounded(law.filter.ground_damping_n_m_s_per_rad * root);
    law.filter.stiffness_n_m_per_rad = rounded(law.filter.stiffness_n_m_per_rad * stiffness);
    law.k_soft_n_m_per_rad = rounded(law.k_soft_n_m_per_rad * stiffness);
    scene
}

/// Examines settings around a tuned law; calls `progress` after each. `quick` tries only a few.
pub fn points(tuned: &Tuned, quick: bool, progress: impl Fn() + Sync) -> Vec<Point> {
    let estimated = tuned.scene.law.states == StatesKind::Estimated;
    let damped = matches!(
        tuned.scene.law.kind,
        LawKind::SpringDamper | LawKind::EnhancedSfa
    );
    let bandwidths: &[f64] = if estimated { &BANDWIDTHS } else { &[1.0] };
    let dampings: &[f64] = if damped { &DAMPINGS } else { &[1.0] };
    let mut tried = Vec::new();
    for stiffness in STIFFNESSES {
        for bandwidth in bandwidths {
            for damping in dampings {
                if !quick || (*bandwidth == 1.0 && (*damping == 1.0 || *damping == 0.7)) {
                    tried.push((stiffness, *bandwidth, *damping));
                }
            }
        }
    }
    let mut points: Vec<Point> = tried
        .par_iter()
        .filter_map(|(stiffness, bandwidth, damping)| {
            let scene = scaled(&tuned.scene, *stiffness, *bandwidth, *damping);
            let judgement = Judgement::new(&scene, tuned.reference, quick);
            let held = judgement.holds(&scene).map(|nominal| Point {
                k_desired: scene.wall.k_desired_n_m_per_rad,
                ripple_rms_n_m: nominal.get(Measure::RippleRmsNM),
                delay_margin_ticks: delay_margin(&judgement, &scene),
                bandwidth_hz: estimated.then_some(scene.law.estimator.bandwidth_hz),
                best: true,
            });
            progress();
            held
        })
        .collect();
    let copy = points.clone();
    for point in &mut points {
        point.best = !copy.iter().any(|other| dominates(other, point));
    }
    points.sort_by(|a, b| {
        a.k_desired
            .total_cmp(&b.k_desired)
            .then(a.ripple_rms_n_m.total_cmp(&b.ripple_rms_n_m))
    });
    points
}

/// Number of settings that [`points`] examines.
#[must_use]
pub fn count(tuned: &Tuned, quick: bool) -> u64 {
    let estimated = tuned.scene.law.states == StatesKind::Estimated;
    let damped = matches!(
        tuned.scene.law.kind,
        LawKind::SpringDamper | LawKind::EnhancedSfa
    );
    let each = match (quick, estimated, damped) {
        (true, _, true) => 2,
        (true, _, false) => 1,
        (false, estimated, damped) => {
            (if estimated { BANDWIDTHS.len() } else { 1 })
                * (if damped { DAMPINGS.len() } else { 1 })
        }
    };
    (each * STIFFNESSES.len()) as u64
}

fn dominates(one: &Point, other: &Point) -> bool {
    let as_good = one.k_desired >= other.k_desired
        && one.ripple_rms_n_m <= other.ripple_rms_n_m
        && one.delay_margin_ticks >= other.delay_margin_ticks;
    let better = one.k_desired > other.k_desired
        || one.ripple_rms_n_m < other.ripple_rms_n_m
        || one.delay_margin_ticks > other.delay_margin_ticks;
    as_good && better
}

/// Longest delay in ticks (control periods) at which the nominal device is within the limits for delayed devices, apart from the
/// ripple's.
fn delay_margin(judgement: &Judgement, scene: &Scene) -> f64 {
    let holds = |ticks: f64| {
        let case = Case {
            name: "",
            change: Change::Delay(ticks),
        };
        let limits = Limits::new(true, f64::INFINITY);
        crate::scorecard::figures(scene, judgement.programme(), &case, false)
            .is_ok_and(|(figures, _)| figures.shares(&limits).iter().all(|share| *share <= 1.0))
    };
    let (mut low, mut high) = (0.0, MOST_TICKS);
    if holds(high) {
        return high;
    }
    // To a sixteenth of a tick.
    while high - low > 1.0 / 16.0 {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// Draws ripple over stiffness; the symbol of a point shows its delay margin.
#[must_use]
pub fn figure(points: &[Point]) -> Figure {
    let x = Axis::new(
        "desired stiffness",
        "N·m/rad",
        Range::of(points.iter().map(|point| point.k_desired))
            .with(0.0)
            .padded(0.0, 0.1),
    );
    let y = Axis::new(
        "ripple",
        "N·m",
        Range::of(points.iter().map(|point| point.ripple_rms_n_m))
            .with(0.0)
            .padded(0.0, 0.1),
    );
    let mut figure = Figure::new("Ripple over stiffness", x, y);
    figure.description =
        "Settings that hold every device of their cases. Full dots: no other is better in stiffness, ripple and delay together, and they hold a control period of delay or more. Triangles: the same with less delay. Rings: another is better in all three."
            .to_owned();
    let signs = |keep: &dyn Fn(&&Point) -> bool, sign: Sign| {
        Shape::Signs(
            points
                .iter()
                .filter(keep)
                .map(|point| (point.k_desired, point.ripple_rms_n_m, sign))
                .collect(),
        )
    };
    figure.line("surf", "another is better", signs(&|p| !p.best, Sign::Ring));
    figure.line(
        "force",
        "holds less than a tick of delay",
        signs(&|p| p.best && p.delay_margin_ticks < 1.0, Sign::Triangle),
    );
    figure.line(
        "hip",
        "holds a tick of delay or more",
        signs(&|p| p.best && p.delay_margin_ticks >= 1.0, Sign::Dot),
    );
    figure
}
