//! Compares a recording of a device with its simulation. The scene is simulated with the recorded hand, and positions and commanded
//! torques are compared tick by tick (control periods).
//!
//! There are two cases. If the hand had let go, the knob is simulated without a hand, with the speed that it had. If the hand held
//! the knob, the simulation uses the scene's grip, with a rest point computed from the device's motion. The replay contains no
//! motion of the hand above about 20 Hz, and a person's real grip may differ from the scene's.

mod fit;
mod held;
mod page;
mod recording;
mod replay;

pub use fit::Fit;
pub use page::sections;
pub use recording::{WallRecording, counts, encoder};
pub use replay::HAND_FILE;

use serde::Serialize;
use std::path::Path;
use touchstone_sim::error::Result;
use touchstone_sim::scene::Scene;

/// How the hand held the knob while it was recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HandWas {
    /// The hand held the knob all the time.
    Holding,
    /// The hand let the knob go before the first compared tick.
    Gone,
}

/// Difference between the recorded and the simulated course of one quantity (position or force).
#[derive(Debug, Clone, Serialize)]
pub struct Difference {
    /// Name of the compared quantity: `position` or `force`.
    pub what: &'static str,
    /// Unit of the compared quantity.
    pub unit: &'static str,
    /// Root mean square of the difference between recording and simulation.
    pub rms: f64,
    /// Largest difference between recording and simulation.
    pub worst: f64,
    /// Time of the largest difference in the recording, s.
    pub worst_at_s: f64,
    /// Range from the lowest to the highest recorded value.
    pub span: f64,
    /// Root mean square of the difference, as a fraction of `span`.
    pub share: f64,
    /// Time in the recording at which the difference first exceeded [`PARTS`] times `span`, s; `None` if it never did.
    pub parts_at_s: Option<f64>,
}

/// Fraction of the recorded range above which recording and simulation count as different.
pub const PARTS: f64 = 0.05;

/// Comparison of a recording with its simulation: both courses tick by tick, their differences, and the best fits.
#[derive(Debug, Clone)]
pub struct Beside {
    /// Time of each compared sample in the recording, s.
    pub time_s: Vec<f64>,
    /// Penetration as the encoder measures it, rad: first recorded, then simulated.
    pub penetration_rad: [Vec<f64>; 2],
    /// Force commanded out of the wall, N·m: first recorded, then simulated.
    pub force_n_m: [Vec<f64>; 2],
    /// Differences between recording and simulation: of the position, then of the force.
    pub differences: [Difference; 2],
    /// Best factor on each property of the knob, varied alone; the property that matches best comes first.
    pub fits: Vec<Fit>,
    /// Number of ticks (control periods) that are missing in the whole recording.
    pub lost_ticks: u32,
    /// Number of ticks in which the device limited the force; the scene does not describe such limits.
    pub limited_ticks: usize,
}

impl Beside {
    /// Whether the root mean square differences of position and force are at most the fraction `share` of their recorded ranges.
    #[must_use]
    pub fn holds(&self, share: f64) -> bool {
        self.differences.iter().all(|it| it.share <= share)
    }

    /// The comparison as JSON: differences and fits, without the courses.
    #[must_use]
    pub fn to_json(&self) -> serde_json::Value {
        serde_json::json!({
            "ticks": self.time_s.len(),
            "from_s": self.time_s.first(),
            "to_s": self.time_s.last(),
            "lost_ticks": self.lost_ticks,
            "limited_ticks": self.limited_ticks,
            "differences": self.differences,
            "fits": self.fits,
        })
    }
}

/// Simulates the scene with the recorded hand and compares the courses of position and force. If the hand held the knob, the
/// hand's computed motion is written to a file in `folder`.
///
/// # Errors
/// The recording does not fit the scene's encoder or rate, or is too short for this case; or the scene is not valid.
pub fn beside(scene: &Scene, told: &WallRecording, hand: HandWas, folder: &Path) -> Result<Beside> {
    let replay = replay::Replay::new(scene, told, hand, folder)?;
    let simulated = replay.run(replay.scene())?;
    let recorded = replay.recorded();
    let time_s = recorded.time_s.to_vec();
    let penetration_rad = [recorded.penetration_rad.to_vec(), simulated.penetration_rad];
    let force_n_m = [recorded.force_n_m.to_vec(), simulated.force_n_m];
    let differences = [
        difference("position", "rad", &time_s, &penetration_rad),
        difference("force", "N·m", &time_s, &force_n_m),
    ];
    Ok(Beside {
        differences,
        fits: fit::fits(&replay)?,
        lost_ticks: told.lost_ticks,
        limited_ticks: recorded.limited.iter().filter(|it| **it).count(),
        time_s,
        penetration_rad,
        force_n_m,
    })
}

/// Difference of the recorded and the simulated course of a quantity over the same ticks.
fn difference(
    what: &'static str,
    unit: &'static str,
    time_s: &[f64],
    [recorded, simulated]: &[Vec<f64>; 2],
) -> Difference {
    let off = |index: usize| (recorded[index] - simulated[index]).abs();
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for value in recorded {
        (low, high) = (low.min(*value), high.max(*value));
    }
    let span = high - low;
    let worst = (0..time_s.len()).fold(0, |worst, index| match off(index) > off(worst) {
        true => index,
        false => worst,
    });
    let rms = rms(recorded, simulated);
    Difference {
        what,
        unit,
        rms,
        worst: off(worst),
        worst_at_s: time_s[worst],
        span,
        // If the recording does not change, any difference counts as infinite.
        share: if rms == 0.0 { 0.0 } else { rms / span },
        parts_at_s: (0..time_s.len())
            .find(|index| off(*index) > PARTS * span)
            .map(|index| time_s[index]),
    }
}

/// Finds the argument with the least cost; returns argument and cost. The search tries a grid of `steps` steps to either side of
/// 0, then halves the step around the best argument `halvings` times.
fn closest(
    mut step: f64,
    steps: i32,
    halvings: u32,
    cost: impl Fn(f64) -> Result<f64>,
) -> Result<(f64, f64)> {
    let mut best = (0.0, cost(0.0)?);
    let mut looked: Vec<f64> = (-steps..=steps).map(|at| step * f64::from(at)).collect();
    for _ in 0..=halvings {
        for at in looked {
            let found = cost(at)?;
            if found < best.1 {
                best = (at, found);
            }
        }
        step *= 0.5;
        looked = vec![best.0 - step, best.0 + step];
    }
    Ok(best)
}

/// Root mean square of the difference of two courses.
fn rms(one: &[f64], other: &[f64]) -> f64 {
    let squares: f64 = one.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum();
    (squares / one.len().max(1) as f64).sqrt()
}
