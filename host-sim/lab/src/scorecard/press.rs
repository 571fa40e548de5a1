//! What is read off a press, tick by tick: of a knob's angle or of a depth along a normal.

use super::measure::{Figures, Measure};

/// Counts below which a stiffness cannot be told.
pub const SHALLOW_COUNTS: f64 = 10.0;
/// From the end of a ramp until a press is judged as held, s.
pub const HELD_AFTER_S: f64 = 0.05;

/// The stiffness that is asked for, and how well a penetration is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DesiredStiffness {
    /// `k_de`.
    pub k_desired: f64,
    /// Step of a measured position.
    pub count: f64,
    /// What a measured penetration may be off: half a count of a knob, half a count of each axis along a normal.
    pub unsure: f64,
}

impl DesiredStiffness {
    /// By how much a force is off `k_de x`, over it, after what the penetration is unsure by; `None` where it is too shallow to tell.
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
    /// What is asked for.
    pub stiffness: DesiredStiffness,
    /// What the hand pushes with.
    pub push: f64,
    /// Tick with which the press' ramp begins; before it is the touch.
    pub ramp_start: u64,
    /// From when on it is held.
    pub held_from: u64,
    /// When the hand begins to let go.
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
