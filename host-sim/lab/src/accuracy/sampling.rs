//! Measures how control rate and encoder resolution change a wall, in runs in which a hand presses, oscillates in the wall and
//! holds still.

use rayon::prelude::*;
use serde::Serialize;
use touchstone_sim::error::Result;
use touchstone_sim::run;
use touchstone_sim::scene::{Preset, Scene};
use touchstone_world::plant::critical_stiffness;

/// Results of one run at one control rate and encoder resolution.
#[derive(Debug, Clone, Serialize)]
pub struct SamplingPoint {
    /// Name of the control law. `shipped` is enhanced successive force augmentation with state estimator and energy guard; the
    /// other laws have the thesis' settings.
    pub law: &'static str,
    /// Requested stiffness of the wall, N·m/rad.
    pub k_desired_n_m_per_rad: f64,
    /// Control rate, Hz.
    pub rate_hz: u32,
    /// Encoder counts per turn.
    pub counts_per_rev: u32,
    /// Verdict on the run; `refused` if the law's settings are not possible at this rate.
    pub verdict: &'static str,
    /// Displayed stiffness at rest divided by the requested stiffness, minus 1.
    pub stiffness_error: Option<f64>,
    /// Amplitude of the force over that of the penetration while the hand oscillates, divided by the requested stiffness, minus 1.
    pub dynamic_stiffness_error: Option<f64>,
    /// Phase of the force relative to the penetration while the hand oscillates, degrees; positive if the force leads.
    pub dynamic_stiffness_phase_deg: Option<f64>,
    /// Root mean square of the change of the torque from tick to tick (ripple), N·m.
    pub ripple_rms_n_m: Option<f64>,
    /// Most energy that the wall gave out in any window of time, J.
    pub energy_out_wall_worst_window_j: Option<f64>,
    /// Most energy that the hand got out of the device in any window of time, J.
    pub energy_out_worst_window_j: Option<f64>,
    /// Stiffness in N·m/rad at which the loop of wall and bare device becomes unstable at this rate, calculated from eigenvalues.
    pub k_max_n_m_per_rad: f64,
    /// Largest fraction (0 to 1) of the board's processor time, for the most expensive law. `None` at a rate that no board accepts.
    pub board_load_at_most: Option<f64>,
}

/// Control laws with their requested stiffnesses in N·m/rad: a spring that is stable even at the slowest rate, and laws for stiffer
/// walls.
const LAWS: [(&str, f64); 3] = [("spring", 0.4), ("enhanced-sfa", 5.0), ("shipped", 5.0)];

/// Simulates a press with every control law at every control rate and encoder resolution.
///
/// # Errors
/// A scene cannot be run.
pub fn points(rates_hz: &[u32], counts_per_rev: &[u32]) -> Result<Vec<SamplingPoint>> {
    let mut wanted = Vec::new();
    for law in LAWS {
        for &rate_hz in rates_hz {
            for &counts in counts_per_rev {
                wanted.push((law, rate_hz, counts));
            }
        }
    }
    wanted
        .into_par_iter()
        .map(|(law, rate_hz, counts)| point(law, rate_hz, counts))
        .collect()
}

fn point(
    (law, stiffness): (&'static str, f64),
    rate_hz: u32,
    counts: u32,
) -> Result<SamplingPoint> {
    let (preset, kind) = match law {
        "shipped" => (Preset::Shipped, "enhanced-sfa"),
        law => (Preset::Thesis, law),
    };
    let scene = Scene::load("press-wiggle-release")?
        .with_preset(preset)?
        .with_overrides(&[
            format!("law.kind={kind}"),
            format!("wall.k_desired_n_m_per_rad={stiffness}"),
            format!("timing.rate_hz={rate_hz}"),
            format!("encoder.counts_per_rev={counts}"),
        ])?;
    let device = touchstone_world::plant::Device {
        friction: None,
        ..run::plan::device(&scene)
    };
    let k_max_n_m_per_rad =
        critical_stiffness(&device, None, f64::from(rate_hz), 0.0).unwrap_or(f64::NAN);
    // Settings that were tuned for one rate may be impossible at another. That is a result; the other runs continue.
    let Ok(run) = run::run(&scene, false) else {
        return Ok(SamplingPoint {
            law,
            k_desired_n_m_per_rad: stiffness,
            rate_hz,
            counts_per_rev: counts,
            verdict: "refused",
            stiffness_error: None,
            dynamic_stiffness_error: None,
            dynamic_stiffness_phase_deg: None,
            ripple_rms_n_m: None,
            energy_out_wall_worst_window_j: None,
            energy_out_worst_window_j: None,
            k_max_n_m_per_rad,
            board_load_at_most: super::board::load_at_most(rate_hz),
        });
    };
    let summary = run.summary;
    let dynamic = summary.dynamic_stiffness.first();
    Ok(SamplingPoint {
        law,
        k_desired_n_m_per_rad: stiffness,
        rate_hz,
        counts_per_rev: counts,
        verdict: summary.verdict_name(),
        stiffness_error: summary.k_displayed.map(|k| k / stiffness - 1.0),
        dynamic_stiffness_error: dynamic.map(|d| d.modulus_n_m_per_rad / stiffness - 1.0),
        dynamic_stiffness_phase_deg: dynamic.map(|d| d.phase_deg),
        ripple_rms_n_m: summary.ripple_rms_n_m,
        energy_out_wall_worst_window_j: Some(summary.energy_out_wall_worst_window_j),
        energy_out_worst_window_j: Some(summary.energy_out_worst_window_j),
        k_max_n_m_per_rad,
        board_load_at_most: super::board::load_at_most(rate_hz),
    })
}
