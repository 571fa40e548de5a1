//! Computes the rest point of the hand that held a knob (the angle to which the hand pulled the knob), from the device's recorded
//! positions and commanded torques.
//!
//! The equations of motion of device and hand are solved for the hand's motion. The torque between hand and device is the torque
//! that moves the device against the wall's force. This torque compresses the fingertip pad; the compression gives the position
//! of the fingers. The torque, with the torques of the hand's own inertia and damping, stretches the spring of the hand. All
//! curves are smoothed to below [`SMOOTHING_HZ`](touchstone_sim::scene::SMOOTHING_HZ), so that encoder steps do not count as
//! motion.

use super::recording::WallRecording;
use touchstone_sim::error::{Error, Result};
use touchstone_sim::scene::{Curve, Scene};

/// Speed of the device below which friction is assumed proportional to the speed, rad/s. A device this slow may be stuck.
const SLOW_RAD_PER_S: f64 = 0.02;

/// The hand's rest point in every tick of the recording, as a penetration of the wall, rad.
pub fn rest_point_rad(scene: &Scene, told: &WallRecording) -> Result<Vec<f64>> {
    let hand = scene.operator.hand().ok_or_else(|| Error::Option {
        option: "--hand held".into(),
        problem: format!("no hand holds the device in the scene {}", scene.name),
        fix: "give it a grip: --set operator.grip=medium; or --hand released".into(),
    })?;
    let times: Vec<f64> = told
        .time_s
        .iter()
        .map(|time| time - told.time_s[0])
        .collect();
    let period = times[1] - times[0];
    let smooth = |values: &[f64]| -> Vec<f64> {
        let curve = Curve::smooth(&times, values);
        times.iter().map(|time| curve.at(*time)).collect()
    };
    let slope = |values: &[f64]| derivative(values, period);
    let device = &scene.device;
    let place = smooth(&told.penetration_rad);
    let speed = slope(&place);
    let friction = device.friction.as_ref().map_or(0.0, |it| it.kinetic_n_m);
    let (force, pushed) = (smooth(&told.force_n_m), slope(&speed));
    let torque: Vec<f64> = (0..times.len())
        .map(|at| {
            let dry = friction * speed[at] / speed[at].abs().max(SLOW_RAD_PER_S);
            force[at]
                + device.inertia_kg_m2 * pushed[at]
                + device.damping_n_m_s_per_rad * speed[at]
                + dry
        })
        .collect();
    let (stiff, lossy) = (
        hand.pad_stiffness_n_m_per_rad,
        hand.pad_damping_n_m_s_per_rad,
    );
    let rising = slope(&torque);
    let fingers: Vec<f64> = (0..times.len())
        .map(|at| place[at] + (torque[at] - lossy * rising[at] / stiff) / stiff)
        .collect();
    let (speed, pushed) = (slope(&fingers), slope(&slope(&fingers)));
    Ok((0..times.len())
        .map(|at| {
            let own = hand.inertia_kg_m2 * pushed[at] + hand.damping_n_m_s_per_rad * speed[at];
            fingers[at] + (torque[at] + own) / hand.stiffness_n_m_per_rad
        })
        .collect())
}

/// Derivative by central differences; 0 at the first and last value.
fn derivative(values: &[f64], period: f64) -> Vec<f64> {
    let last = values.len() - 1;
    let slope = |at: usize| match at {
        0 => 0.0,
        at if at == last => 0.0,
        at => (values[at + 1] - values[at - 1]) / (2.0 * period),
    };
    (0..values.len()).map(slope).collect()
}
