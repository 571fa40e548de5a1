//! A recording of a device compared with its simulation: the scene is run under the recorded hand, tick by tick beside
//! the measured positions and commanded torques.
//!
//! Two kinds of hand can be replayed. A hand that let go is no hand: the knob flies with the speed that it had. A hand
//! that holds is the scene's grip, with a rest point found from the device's motion. The replay has no motion of the
//! hand above some 20 Hz, and does not know that a person's grip may differ from the scene's.

mod fit;
mod held;
mod page;
mod replay;
mod told;

pub use fit::Fit;
pub use page::sections;
pub use replay::HAND_FILE;
pub use told::Told;

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

/// How one quantity was, and how it would be.
#[derive(Debug, Clone, Serialize)]
pub struct Difference {
    /// `position` or `force`.
    pub what: &'static str,
    /// The unit of the values.
    pub unit: &'static str,
    /// Root of the mean square of the difference.
    pub rms: f64,
    /// The largest difference.
    pub worst: f64,
    /// Time of the largest difference, in the recording's time, s.
    pub worst_at_s: f64,
    /// Range from the lowest to the highest recorded value.
    pub span: f64,
    /// The rms as a share of that span.
    pub share: f64,
    /// Time at which the difference first left [`PARTS`] of the span, in the recording's time, s; never: `None`.
    pub parts_at_s: Option<f64>,
}

/// Share of a span from which on the two have parted.
pub const PARTS: f64 = 0.05;

/// Recording and simulation, tick by tick, and the findings.
#[derive(Debug, Clone)]
pub struct Beside {
    /// Times of the samples, in the recording's time, s.
    pub time_s: Vec<f64>,
    /// Penetration as the encoder measures it, rad: recorded, simulated.
    pub penetration_rad: [Vec<f64>; 2],
    /// Force commanded out of the wall, N·m: recorded, simulated.
    pub force_n_m: [Vec<f64>; 2],
    /// Position and force.
    pub differences: [Difference; 2],
    /// The factor on each property of the knob that would match best, each alone; the best first.
    pub fits: Vec<Fit>,
    /// Ticks missing in the recording, before and after the compared part.
    pub lost_ticks: u32,
    /// Ticks in which a limit of the device acted, which the scene knows nothing of.
    pub limited_ticks: usize,
}

impl Beside {
    /// Whether both differences stay within a share of the recorded spans.
    #[must_use]
    pub fn holds(&self, share: f64) -> bool {
        self.differences.iter().all(|it| it.share <= share)
    }

    /// JSON for programs.
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

/// Runs the scene under the recorded hand and puts both side by side. `folder` gets the hand's motion where there is one.
///
/// # Errors
/// A recording that is not of this scene's encoder or rate, or that has too little for this hand; whatever is wrong with the scene.
pub fn beside(scene: &Scene, told: &Told, hand: HandWas, folder: &Path) -> Result<Beside> {
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

/// The difference of two courses over the same ticks.
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
        // Where nothing was recorded any difference is all of it.
        share: if rms == 0.0 { 0.0 } else { rms / span },
        parts_at_s: (0..time_s.len())
            .find(|index| off(*index) > PARTS * span)
            .map(|index| time_s[index]),
    }
}

/// The place of the least cost, and that cost: first on a grid with this many steps to both sides of 0, then by
/// halving.
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

/// Root of the mean square of what two courses differ by.
fn rms(one: &[f64], other: &[f64]) -> f64 {
    let squares: f64 = one.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum();
    (squares / one.len().max(1) as f64).sqrt()
}
