//! The intended motion of the simulated hand over time, as the rest point of the hand's spring.

pub(super) mod column;
mod held;
mod odd;
mod once;
mod press;
mod recording;
mod resample;
pub(super) mod tap;
#[cfg(test)]
mod tests;

pub use recording::Recording;
pub(super) use recording::line_of;
pub use resample::{Curve, SMOOTHING_HZ};

use super::experiment::Scene;
use super::operator::{APPROACH_RAD, MotionSpec, Turn};
use crate::error::Result;
use held::Held;
use press::Press;
use tap::TapPath;

/// The hand's moving rest point `r(t)`, rad: the end of the hand's spring that the person moves on purpose.
///
/// Computed motions are smooth: the slope of `r` is continuous, and its frequencies are those of voluntary motion, up to about 10
/// Hz; only a wiggle may have up to 16 Hz. A recording that is replayed exactly moves in steps.
#[derive(Debug, Clone)]
pub struct RestPath {
    shape: Shape,
    note: Option<String>,
}

#[derive(Debug, Clone)]
enum Shape {
    Still(f64),
    Press(Press),
    Tap(TapPath),
    Turn(Turn),
    Recorded(Curve),
    Held(Held),
}

impl Scene {
    /// Initial angle of the device, rad: the angle that the scene gives, else the first rest point of the hand.
    pub fn start_rad(&self, motion: &RestPath) -> f64 {
        self.device
            .initial_angle_rad
            .unwrap_or_else(|| motion.rest_rad(0.0))
    }
}

impl RestPath {
    /// Prepares the hand's motion of a scene, and reads the recording if the scene names one.
    ///
    /// # Errors
    /// The recording cannot be used, see [`Recording::read`]; the scene has a press or a tap but no hand.
    pub fn from_scene(scene: &Scene) -> Result<RestPath> {
        let surface = scene.wall.surface_rad;
        let hand = || {
            scene.operator.hand().ok_or_else(|| {
                scene.error(
                    "operator.motion.kind",
                    "no hand holds the device",
                    "give operator.grip = \"medium\"",
                )
            })
        };
        let mut note = None;
        let shape = match &scene.operator.motion {
            MotionSpec::None => Shape::Still(
                scene
                    .device
                    .initial_angle_rad
                    .unwrap_or(surface - APPROACH_RAD),
            ),
            MotionSpec::RampAndHold(spec) => {
                Shape::Press(Press::ramp_and_hold(spec, &hand()?, &scene.wall))
            }
            MotionSpec::PressWiggleRelease(spec) => {
                Shape::Press(Press::wiggle(spec, &hand()?, &scene.wall))
            }
            MotionSpec::TouchAndPress(spec) => {
                Shape::Press(Press::touch_and_press(spec, &hand()?, &scene.wall))
            }
            MotionSpec::Tap(spec) => {
                Shape::Tap(TapPath::new(spec, &hand()?, &scene.device, surface))
            }
            MotionSpec::Turn(spec) => Shape::Turn(spec.clone()),
            MotionSpec::Recorded(spec) => {
                let recording = Recording::read(&spec.file)?;
                let cut = recording.cut_by(&scene.timing);
                if spec.exact {
                    let held = Held::of(&recording);
                    let shape = Shape::Held(held);
                    let note = cut.map(|cut| format!("{}: {cut}", recording.shown()));
                    return Ok(RestPath { shape, note });
                }
                let curve = recording.placed(surface, spec);
                let placed = recording.note(surface, spec, &curve);
                note = Some(match cut {
                    Some(cut) => format!("{placed}; {cut}"),
                    None => placed,
                });
                Shape::Recorded(curve)
            }
        };
        Ok(RestPath { shape, note })
    }

    /// Motion of a hand whose rest point stays at one angle, rad.
    pub fn still(rest_rad: f64) -> RestPath {
        RestPath {
            shape: Shape::Still(rest_rad),
            note: None,
        }
    }

    /// The hand's rest point at the time `time_s`, rad. The simulation calls this method once per control period.
    pub fn rest_rad(&self, time_s: f64) -> f64 {
        match &self.shape {
            Shape::Still(angle) => *angle,
            Shape::Press(press) => press.rest_rad(time_s),
            Shape::Tap(tap) => tap.rest_rad(time_s),
            Shape::Turn(turn) => turn.rest_rad(time_s),
            Shape::Recorded(curve) => curve.at(time_s),
            Shape::Held(held) => held.at(time_s),
        }
    }

    /// Rest point in rad of a hand without a motion; `None` for a hand that moves.
    pub fn still_rad(&self) -> Option<f64> {
        match self.shape {
            Shape::Still(angle) => Some(angle),
            _ => None,
        }
    }

    /// One line for users. It says how the recording was placed on the wall and smoothed, and whether the run ends before the
    /// recording. `None` for motions without a recording.
    pub fn note(&self) -> Option<&str> {
        self.note.as_deref()
    }
}

impl Turn {
    fn rest_rad(&self, time_s: f64) -> f64 {
        let back_s = self.start_s + self.turn_s + self.stay_s;
        let there = minimum_jerk((time_s - self.start_s) / self.turn_s);
        let back = minimum_jerk((time_s - back_s) / self.turn_s);
        self.from_rad + self.angle_rad * (there - back)
    }
}

/// Minimum-jerk step from 0 to 1: the profile by which people move from rest to rest. `share` is the elapsed fraction of the
/// motion's duration, 0 to 1.
///
/// First and second derivative are 0 at both ends.
pub(super) fn minimum_jerk(share: f64) -> f64 {
    let s = share.clamp(0.0, 1.0);
    s * s * s * (10.0 + s * (6.0 * s - 15.0))
}
