//! The values of a scene.

use serde::{Deserialize, Serialize};

use super::device::{DeviceSpec, Encoder, Plant, Timing, Wall};
use super::effects::SensorErrors;
use super::environment::Environment;
use super::law::Law;
use super::operator::Operator;
use super::origin::Origin;
use crate::error::Error;

/// One experiment: a device, a wall, a law and a person.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Scene {
    /// Name in tables and results. Default: the file's name without its ending.
    pub name: String,
    /// Description of the scene in words. Default: empty.
    pub description: String,
    /// Where everything random begins; 0 to 4,294,967,295. Absent: 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seed: Option<u32>,
    /// The device that the hand moves.
    pub device: DeviceSpec,
    /// Position sensor. Absent: the law sees the exact position.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub encoder: Option<Encoder>,
    /// Errors of the position sensor. Default: none.
    pub sensor: SensorErrors,
    /// How the plant crosses a tick. Absent: by the exact step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plant: Option<Plant>,
    /// Rate, duration, delay.
    pub timing: Timing,
    /// The virtual wall.
    pub wall: Wall,
    /// The environment beside the wall. Absent: nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub environment: Option<Environment>,
    /// The law and its parameters.
    pub law: Law,
    /// The person.
    pub operator: Operator,
    /// Where each value was written. No part of the scene's meaning.
    #[serde(skip)]
    pub origin: Origin,
}

impl Scene {
    /// The error for a field of this scene, by its dotted path (`law.k_soft_n_m_per_rad`), with the place where it was
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
