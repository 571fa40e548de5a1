//! Measures of a touch beside those of an ideal wall.

use serde::Serialize;

/// Measures of a touch, divided by those of the ideal damped wall; the worst of several hands.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TouchRatios {
    /// Deepest penetration of the touch, divided by that of the ideal damped wall; smaller is better.
    pub penetration: f64,
    /// Rate-hardness (slope of the torque just after contact over the speed of the touch), divided by the requested stiffness;
    /// larger is better. It may be negative for a damped wall.
    pub rate_hardness: Option<f64>,
    /// Extended rate-hardness (largest rise of the torque within a millisecond over the largest speed), divided by that of the
    /// ideal damped wall; larger is better.
    pub extended_rate_hardness: Option<f64>,
    /// Largest torque in the first five milliseconds of the touch, divided by that of the ideal damped wall; larger is better.
    pub torque: Option<f64>,
}

impl TouchRatios {
    /// The worse value of each measure from two sets.
    #[must_use]
    pub fn worst(&self, other: &Self) -> Self {
        let less = |one: Option<f64>, other: Option<f64>| Some(one?.min(other?));
        Self {
            penetration: self.penetration.max(other.penetration),
            rate_hardness: less(self.rate_hardness, other.rate_hardness),
            extended_rate_hardness: less(self.extended_rate_hardness, other.extended_rate_hardness),
            torque: less(self.torque, other.torque),
        }
    }
}
