//! Specification of a tick of the velocity filters of a spring-damper, in integers. Read it beside the headers of
//! `control/src/velocity/`.
//!
//! A motion is one of [`super::estimator`]: its displacements have 54 fractional bits, and a weight (coefficient) has the
//! fractional bits that a product needs for 54.

use super::Int;
use super::estimator::{Flow, Motion, REMEMBERED, corrected, shown, state, weighed, within};
pub use super::window::{LONGEST, window};

/// Number of binary digits of a state below its part, the leading digits that are multiplied.
const BELOW_PART: u32 = 54 - 28;

/// First-order filter of the velocity: the new velocity is `v + a (x - x' - v)`, with the last velocity `v`, the gain `a`, the
/// position `x` and the last position `x'`. `None` if no device can move like that.
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

/// A Kalman filter in its steady state: the estimator's correction for a device that keeps its acceleration and gets no commands.
/// `None` if no device can move like that.
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

/// The filter's memory after a measured position, and the velocity. If no device can move like that (`None`), the device is taken
/// to be at rest at this position.
#[must_use]
pub fn told(after: Option<Motion>, at: Int) -> (Motion, Int) {
    let motion = after.unwrap_or(Motion {
        x: state(at),
        d: 0,
        g: 0,
    });
    (motion, shown(motion.d))
}
