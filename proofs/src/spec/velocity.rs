//! Specification ticks of the velocity filters of a spring-damper, by whole numbers: read them beside the headers of `control/src/velocity/`.
//!
//! A motion is as in [`super::estimator`]: displacements with 54 fractional bits, weights with what is missing to them.

use super::estimator::{Flow, Motion, REMEMBERED, corrected, shown, state, weighed, within};
use super::{Int, SIGNAL, signal};

/// Positions that a window reaches back at most.
pub const LONGEST: usize = 16;

/// Digits of a state that are no part of what is multiplied.
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

/// The memory after a position, and the velocity that is told: a device that could not have moved like that stands.
#[must_use]
pub fn told(after: Option<Motion>, at: Int) -> (Motion, Int) {
    let motion = after.unwrap_or(Motion {
        x: state(at),
        d: 0,
        g: 0,
    });
    (motion, shown(motion.d))
}

/// A quotient's bound: so far in so many ticks.
type Bound = Option<(Int, Int)>;

/// The slope of the longest window, up to `longest` ticks, through whose first and last position a line passes all others by no more than the
/// margin. Positions that were measured before, the latest first.
#[must_use]
pub fn window(past: &[Int; LONGEST], at: Int, longest: usize, margin: Int) -> Int {
    let (mut least, mut most): (Bound, Bound) = (None, None);
    let mut slope = 0;
    for n in 1..=longest.min(LONGEST) {
        let ticks = n as Int;
        let way = signal(at - past[n - 1]);
        // Of quotients, by products: way/n against bound/m.
        let is_below = |x: Int, (bound, m): (Int, Int)| x * m < bound * ticks;
        let is_above = |x: Int, (bound, m): (Int, Int)| x * m > bound * ticks;
        if least.is_some_and(|bound| is_below(way, bound))
            || most.is_some_and(|bound| is_above(way, bound))
        {
            break;
        }
        // A nth, with the digits of a ratio, towards zero, as is the part of the way.
        let share = (1 << SIGNAL) / ticks;
        let size = (share * way.abs()) >> SIGNAL;
        slope = if way < 0 { -size } else { size };
        let (low, high) = (signal(way - margin), signal(way + margin));
        if least.is_none_or(|bound| is_above(low, bound)) {
            least = Some((low, ticks));
        }
        if most.is_none_or(|bound| is_below(high, bound)) {
            most = Some((high, ticks));
        }
    }
    slope
}
