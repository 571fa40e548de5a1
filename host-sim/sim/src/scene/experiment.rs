//! A scene: all values that describe one simulation.

use serde::{Deserialize, Serialize};

use super::device::{DeviceSpec, Encoder, Plant, Timing, Wall};
use super::effects::SensorErrors;
use super::environment::Environment;
use super::law::Law;
use super::operator::Operator;
use super::origin::Origin;
use crate::error::Error;

/// One experiment: device, wall, control law and hand.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Scene {
    /// Name in tables and results. Default: the file's name without its ending.
    pub name: String,
    /// Description of the scene in words. Default: empty.
    pub description: String,
    /// Seed of all random numbers, 0 to 4,294,967,295. Absent: 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u32>,
    /// The device that the hand moves.
    pub device: DeviceSpec,
    /// Position sensor. Absent: the law sees the exact position.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub encoder: Option<Encoder>,
    /// Errors of the position sensor. Default: none.
    pub sensor: SensorErrors,
    /// Integration method of device and hand over a control period. Absent: the exact step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plant: Option<Plant>,
    /// Control rate, duration and delay.
    pub timing: Timing,
    /// The virtual wall.
    pub wall: Wall,
    /// The environment beside the wall. Absent: nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub environment: Option<Environment>,
    /// The law and its parameters.
    pub law: Law,
    /// The person at the knob: grip and intended motion.
    pub operator: Operator,
    /// Place in the file or command line where each value was written, for messages only.
    #[serde(skip)]
    pub origin: Origin,
}

impl Scene {
    /// Error for the field with the dotted path `path` (such as `law.k_soft_n_m_per_rad`). It names the place where the field was
    /// written.
    pub fn error(&self, path: &str, problem: impl Into<String>, fix: impl Into<String>) -> Error {
        self.origin.error(path, problem, fix)
    }

    /// Start and end of the time over which displayed stiffness and limit cycle are judged, s; `None` without a quiet
    /// hold.
    pub fn hold_window_s(&self) -> Option<(f64, f64)> {
        self.operator.motion.hold_window_s()
    }
}
