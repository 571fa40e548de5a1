//! Figures of a press, tick by tick: from a knob's angle, or from a depth along a normal.

use super::measure::{Figures, Measure};

/// Depth in counts below which a stiffness cannot be measured.
pub const SHALLOW_COUNTS: f64 = 10.0;
/// Time from the end of a ramp until a press is judged as held, s.
pub const HELD_AFTER_S: f64 = 0.05;

/// The desired stiffness, and how exactly a penetration is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DesiredStiffness {
    /// Desired stiffness: `k_de`.
    pub k_desired: f64,
    /// Step of a measured position.
    pub count: f64,
    /// Uncertainty of a measured penetration: half a count of a knob, half a count of each axis along a normal.
    pub unsure: f64,
}

impl DesiredStiffness {
    /// Relative error of a force against `k_de x`, beyond the penetration's uncertainty; `None` where the depth is too
    /// small.
    #[must_use]
    pub fn off(&self, x: f64, force: f64) -> Option<f64> {
        let k = self.k_desired;
        (x > SHALLOW_COUNTS * self.count && x > 0.0)
            .then(|| ((force - k * x).abs() - k * self.unsure).max(0.0) / (k * x))
    }
}

/// A press of a wall. Ticks are indices; penetration and force in the device's own units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PressFigures {
    /// The desired stiffness.
    pub stiffness: DesiredStiffness,
    /// The hand's final push.
    pub push: f64,
    /// Tick with which the press' ramp begins; before it is the touch.
    pub ramp_start: u64,
    /// First tick of the hold.
    pub held_from: u64,
    /// Tick at which the hand begins to let go.
    pub release: u64,
}

impl PressFigures {
    /// Takes a tick: penetration and force. Of a touch before the press, its depth over that of the press.
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
            // The hand is not where it presses: thrown out, or out of the wall.
            figures.raise(Measure::StiffnessErrorHeld, f64::INFINITY);
        }
        None
    }
}
