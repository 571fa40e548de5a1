//! Specification ticks of the velocity filters of a spring-damper, by whole numbers: read them beside the headers of `control/src/velocity/`.
//!
//! A motion is as in [`super::estimator`]: displacements with 54 fractional bits, weights with what is missing to them.

use super::Int;
use super::estimator::{Flow, Motion, REMEMBERED, corrected, shown, state, weighed, within};
pub use super::window::{LONGEST, window};

/// Digits of a state below its part.
const BELOW_PART: u32 = 54 - 28;

/// `v = v + a (x - x' - v)`.
#[must_use]
pub fn smoothed(share: Int, before: Motion, at: Int) -> Option<Motion> {
    let news = state(at) - before.x - before.d;
    if !within(news, 8) {
        return None;
    }
    let d = before.d + weighed(share, news >> BELOW_PART);
    within(d, 4).then_some(Motion {
        x: state(at),
        d,
        ..before
    })
}

/// A Kalman filter in its steady state: the estimator's correction of a device that moves on as it does, without commands.
#[must_use]
pub fn tracked(reach: Int, drift: Int, gains: [Int; 3], before: Motion, at: Int) -> Option<Motion> {
    let free = Flow {
        reach,
        drift,
        loss: 0,
        commands: [],
    };
    corrected(gains, free.end(before, [0; REMEMBERED]), before.g, at)
}

/// The memory after a position, and the velocity; after an impossible motion the device is taken to stand.
#[must_use]
pub fn told(after: Option<Motion>, at: Int) -> (Motion, Int) {
    let motion = after.unwrap_or(Motion {
        x: state(at),
        d: 0,
        g: 0,
    });
    (motion, shown(motion.d))
}
