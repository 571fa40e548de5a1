//! Computes the measures of a press tick by tick, for a knob's angle or for a depth along a wall's normal.

use super::measure::{Figures, Measure};

/// Depth in position counts below which a stiffness is not measured, because one count would be too large a part of the depth.
pub const SHALLOW_COUNTS: f64 = 10.0;
/// Time after the end of a ramp at which the measurement of a held press starts, s.
pub const HELD_AFTER_S: f64 = 0.05;

/// The requested stiffness, with the resolution and uncertainty of a penetration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DesiredStiffness {
    /// Requested stiffness `k_de`, N·m/rad or N/m.
    pub k_desired: f64,
    /// Resolution of the measured position, rad or m.
    pub count: f64,
    /// Uncertainty of a measured penetration, rad or m: half a count of a knob, or half a count of each axis along a normal.
    pub unsure: f64,
}

impl DesiredStiffness {
    /// Relative deviation of a force at the depth `x` from that of an ideal spring, `k_de x`, minus the uncertainty of the
    /// penetration. `k_de` is the requested stiffness. `None` if the depth is below [`SHALLOW_COUNTS`].
    #[must_use]
    pub fn off(&self, x: f64, force: f64) -> Option<f64> {
        let k = self.k_desired;
        (x > SHALLOW_COUNTS * self.count && x > 0.0)
            .then(|| ((force - k * x).abs() - k * self.unsure).max(0.0) / (k * x))
    }
}

/// Computes the measures of a press into a wall. Times are tick numbers; penetration and force are in rad and N·m, or in m and N.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressFigures {
    /// The requested stiffness, with the resolution and uncertainty of a penetration.
    pub stiffness: DesiredStiffness,
    /// Force of the press, N·m on a knob or N along a normal.
    pub push: f64,
    /// First tick of the press' ramp; the light touch comes before.
    pub ramp_start: u64,
    /// First tick in which the press counts as held.
    pub held_from: u64,
    /// First tick in which the hand lets go.
    pub release: u64,
}

impl PressFigures {
    /// Adds a tick with penetration `x` and a force to the measures. During the light touch before the press it only returns the
    /// depth, divided by the ideal depth of the press (force over requested stiffness).
    pub fn take(&self, figures: &mut Figures, index: u64, x: f64, force: f64) -> Option<f64> {
        let depth = x * self.stiffness.k_desired / self.push;
        if index < self.ramp_start {
            return Some(depth);
        }
        figures.raise(Measure::PeakPenetrationRatio, depth);
        let holding = index < self.release;
        let held = holding && index >= self.held_from;
        if let Some(off) = self.stiffness.off(x, force) {
            let measure = if holding {
                Measure::StiffnessError
            } else {
                Measure::StiffnessErrorRelease
            };
            figures.raise(measure, off);
            if held {
                figures.raise(Measure::StiffnessErrorHeld, off);
            }
        } else if held {
            // The knob is not where the hand presses it: it was thrown out of the wall.
            figures.raise(Measure::StiffnessErrorHeld, f64::INFINITY);
        }
        None
    }
}
