//! The settings that are tuned for each control law, and where the search starts.
//!
//! The start is a rule in terms of the device and its wall: requested stiffness `k`, inertia `J` and control period `T`. One rule
//! thus serves all devices. Dampings are in units of `sqrt(k J)`, bandwidths of `sqrt(k/J)/2π`, stiffnesses of `k`, masses of `J`,
//! and fractions per control period of `T sqrt(k/J)`.

use crate::scorecard::rivals::Rival;
use crate::scorecard::stiffness_per_tick;
use std::f64::consts::TAU;
use touchstone_control::choices::{LawKind, StatesKind, VelocityKind};
use touchstone_sim::scene::{Law, Scene};

/// A setting of a control law that can be tuned.
#[derive(Debug, Clone, Copy)]
pub struct Parameter {
    /// Dotted path of the setting in the scene file.
    pub path: &'static str,
    /// Returns a reference to the setting's value in a law, to read or change it.
    pub of: fn(&mut Law) -> &mut f64,
}

/// Start and range of a tuned setting. All values are above 0, because the search works with ratios.
#[derive(Debug, Clone, Copy)]
pub struct Axis {
    /// The setting that is tuned.
    pub parameter: Parameter,
    /// Value of the setting at which the search starts.
    pub start: f64,
    /// Least value of the setting in the search.
    pub least: f64,
    /// Largest value of the setting in the search.
    pub most: f64,
}

macro_rules! parameter {
    ($($field:ident).+) => {
        Parameter {
            path: concat!("law" $(, ".", stringify!($field))+),
            of: |law| &mut law.$($field).+,
        }
    };
}

/// Largest bandwidth of the state estimator in the search, as a fraction of the control rate. The setting itself accepts up to a
/// fifth.
const FASTEST_BANDWIDTH: f64 = 0.19;

/// The settings that are tuned for a law on the device and wall of a scene.
#[must_use]
pub fn axes(rival: &Rival, scene: &Scene) -> Vec<Axis> {
    let own = rival.to_tune(scene);
    let mut axes = of_law(&own);
    if own.law.states == StatesKind::Estimated && !axes.is_empty() {
        axes.extend(of_estimator(&own));
    }
    axes
}

fn of_law(scene: &Scene) -> Vec<Axis> {
    let (j, k) = (scene.device.inertia_kg_m2, scene.wall.k_desired_n_m_per_rad);
    let rate = f64::from(scene.timing.rate_hz);
    let unit = (k * j).sqrt();
    // The fractions per tick were found at T sqrt(k/J) = 0.447.
    let per_ms = (stiffness_per_tick(scene) / 0.447).min(1.0) * (rate / 1000.0);
    let axis = |parameter, start: f64, least: f64, most: f64| Axis {
        parameter,
        start: start.clamp(least, most),
        least,
        most,
    };
    let b = scene.device.damping_n_m_s_per_rad;
    let trusted = || {
        axis(
            parameter!(device_damping_n_m_s_per_rad),
            1.25 * b,
            0.1 * b,
            10.0 * b,
        )
    };
    // The critical stiffness k_c, with the damping that the search assumes at the start.
    let critical = 2.5 * b * rate;
    match scene.law.kind {
        LawKind::Spring => Vec::new(),
        LawKind::SpringDamper => {
            let damping = axis(
                parameter!(virtual_damping_n_m_s_per_rad),
                0.5 * unit,
                0.01 * unit,
                10.0 * unit,
            );
            // The velocity filter starts at three times the device's frequency on the wall: low enough for little ripple, and
            // high enough that its lag does not excite the oscillation that the damping should end.
            let own_hz = (k / j).sqrt() / TAU;
            let velocity = match scene.law.velocity.from {
                VelocityKind::Told => None,
                VelocityKind::Foaw => Some(axis(
                    parameter!(velocity.window_s),
                    0.05 / own_hz,
                    1.0 / rate,
                    16.0 / rate,
                )),
                VelocityKind::Filtered
                | VelocityKind::Kalman
                | VelocityKind::KalmanAcceleration => Some(axis(
                    parameter!(velocity.bandwidth_hz),
                    3.0 * own_hz,
                    rate / 490.0,
                    FASTEST_BANDWIDTH * rate,
                )),
            };
            [damping].into_iter().chain(velocity).collect()
        }
        LawKind::Tdpa | LawKind::Fba => vec![trusted()],
        LawKind::Sfa | LawKind::SfaContinuous => vec![
            trusted(),
            axis(
                parameter!(k_soft_n_m_per_rad),
                0.8 * critical,
                (0.02 * critical).max(0.01),
                k.max(0.02),
            ),
        ],
        LawKind::EnhancedSfa => vec![
            axis(
                parameter!(limit_of_penetration_per_ms),
                0.07 * per_ms,
                1e-4,
                1.0,
            ),
            axis(parameter!(limit_of_force_per_ms), 0.55 * per_ms, 1e-4, 1.0),
            axis(parameter!(step_of_ideal_per_ms), 0.43 * per_ms, 1e-4, 1.0),
            axis(parameter!(filter.mass_kg_m2), 0.03 * j, 1e-3 * j, j),
            axis(
                parameter!(filter.stiffness_n_m_per_rad),
                2.0 * k,
                (0.1 * k).max(0.01),
                30.0 * k,
            ),
            axis(
                parameter!(filter.damping_n_m_s_per_rad),
                0.26 * unit,
                1e-3 * unit,
                10.0 * unit,
            ),
            axis(
                parameter!(filter.ground_damping_n_m_s_per_rad),
                1.5 * unit,
                1e-3 * unit,
                50.0 * unit,
            ),
            // With a soft stiffness of k_de the law is a plain spring.
            axis(
                parameter!(k_soft_n_m_per_rad),
                0.75 * k,
                (0.02 * k).max(0.01),
                0.98 * k,
            ),
            // Virtual damping in addition to the augmented wall; its least value is nearly zero.
            axis(
                parameter!(virtual_damping_n_m_s_per_rad),
                0.05 * unit,
                1e-4 * unit,
                2.0 * unit,
            ),
        ],
    }
}

/// Tuned settings of the state estimator: bandwidth, delay and inertia. Its other settings are not tuned.
fn of_estimator(scene: &Scene) -> Vec<Axis> {
    let j = scene.device.inertia_kg_m2;
    let rate = f64::from(scene.timing.rate_hz);
    let own_hz = (scene.wall.k_desired_n_m_per_rad / j).sqrt() / TAU;
    let fastest = FASTEST_BANDWIDTH * rate;
    let axis = |parameter, start: f64, least: f64, most: f64| Axis {
        parameter,
        start: start.clamp(least, most),
        least,
        most,
    };
    vec![
        axis(
            parameter!(estimator.bandwidth_hz),
            (1.4 * own_hz).max(50.0),
            (0.003 * rate).min(fastest),
            fastest,
        ),
        // The estimator also predicts commands that do not act yet, up to two ticks.
        axis(
            parameter!(estimator.delay_s),
            scene.timing.computational_delay_s + 0.8 / rate,
            0.05 / rate,
            2.0 / rate,
        ),
        axis(parameter!(estimator.inertia_kg_m2), j, 0.25 * j, 4.0 * j),
    ]
}

/// The scene with its law's settings at a point of the search. The point's coordinates are natural logarithms of value over start
/// value. Values are rounded to four digits, so that the evaluated settings equal those in the file.
#[must_use]
pub fn at(rival: &Rival, scene: &Scene, axes: &[Axis], point: &[f64]) -> Scene {
    let mut scene = rival.to_tune(scene);
    // The pulse at the touch is chosen after the search.
    scene.law.impact.share_of_momentum = 0.0;
    for (axis, x) in axes.iter().zip(point) {
        let value = (axis.start * x.exp()).clamp(axis.least, axis.most);
        *(axis.parameter.of)(&mut scene.law) = rounded(value);
    }
    scene
}

/// Rounds a value to four significant digits.
#[must_use]
pub fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}
