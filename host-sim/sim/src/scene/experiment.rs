//! The type of a scene: all values that describe one simulation.

use serde::{Deserialize, Serialize};

use super::device::{DeviceSpec, Encoder, Plant, Timing, Wall};
use super::effects::SensorErrors;
use super::environment::Environment;
use super::law::Law;
use super::operator::Operator;
use super::origin::Origin;
use crate::error::Error;

/// One simulated experiment: device, wall, control law and hand.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Scene {
    /// Name of the scene in tables and results. Default: the file's name without its extension.
    pub name: String,
    /// Description of the scene in words. Default: empty.
    pub description: String,
    /// Seed of all random numbers, 0 to 4,294,967,295. Absent: 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u32>,
    /// The device that the hand moves.
    pub device: DeviceSpec,
    /// Position sensor with counts. Absent: the control law receives the exact position.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub encoder: Option<Encoder>,
    /// Errors of the position sensor. Default: none.
    pub sensor: SensorErrors,
    /// Integration method that advances device and hand over a control period. Absent: the closed-form solution.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plant: Option<Plant>,
    /// Control rate, duration of the run, and computational delay.
    pub timing: Timing,
    /// The virtual wall.
    pub wall: Wall,
    /// Walls, detents and torque profiles in addition to `[wall]`. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub environment: Option<Environment>,
    /// The control law and its parameters.
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

    /// Start and end of the time over which the displayed stiffness is measured, s. `None` for a motion of the hand without a
    /// steady hold, such as a tap or a recording.
    pub fn hold_window_s(&self) -> Option<(f64, f64)> {
        self.operator.motion.hold_window_s()
    }
}
