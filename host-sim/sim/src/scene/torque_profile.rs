//! A torque profile in a scene.

use serde::{Deserialize, Serialize};
use touchstone_control::environment::{Refused, Shape, WHOLE};

/// A torque given as a curve over the angle: equally spaced points, joined by straight lines.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TorqueProfile {
    /// Number of copies of the profile per turn, 1 to 6283. A straight line joins the last point of a copy to the first of the
    /// next.
    ///
    /// With 0 the profile exists once, from `start_rad` to `end_rad`; outside, the torque of the nearer end point acts. Default 6.
    pub per_rev: u32,
    /// Position of the first point, rad. Default 0.
    pub start_rad: f64,
    /// Position of the last point, rad. Only used if `per_rev` is 0. Default 1.
    pub end_rad: f64,
    /// Torque of a point of value 1, N·m, from 0 to the force limit of the control law. Default 0.02.
    pub strength_n_m: f64,
    /// The 2 to 96 points of the profile, each from -1 to 1 and rounded to 0.0001. A positive value pushes towards larger angles.
    ///
    /// Default: a magnetic detent. It attracts the knob within a quarter of the distance between detents on either side, most
    /// strongly at an eighth, and leaves the knob free elsewhere.
    pub shape: Vec<f64>,
}

impl Default for TorqueProfile {
    fn default() -> Self {
        TorqueProfile {
            per_rev: 6,
            start_rad: 0.0,
            end_rad: 1.0,
            strength_n_m: 0.02,
            shape: vec![0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
        }
    }
}

impl TorqueProfile {
    /// Converts the points to the fixed-point format of the control law.
    ///
    /// # Errors
    /// There are fewer than 2 points or more than 96, or a point is outside -1 to 1.
    pub fn points(&self) -> std::result::Result<Shape, Refused> {
        let points: Vec<i16> = (self.shape.iter())
            .map(|point| (point * f64::from(WHOLE)).round() as i16)
            .collect();
        Shape::new(&points)
    }

    /// Converts points in the fixed-point format of the control law to floats for a scene.
    #[must_use]
    pub fn of_points(shape: &Shape) -> Vec<f64> {
        (shape.points().iter())
            .map(|point| f64::from(*point) / f64::from(WHOLE))
            .collect()
    }
}
