//! Specification of the window of first-order adaptive windowing: Janabi-Sharifi, Hayward and Chen, IEEE TCST 8(6) 1003, 2000, with the line
//! through both ends.

use super::{HIGHEST, Int, SIGNAL, signal, times};

/// Positions that a window reaches back at most.
pub const LONGEST: usize = 16;

/// Bound of a quotient: a distance in a number of ticks.
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
        let is_below = |x: Int, (bound, m): (Int, Int)| times(x, m) < times(bound, ticks);
        let is_above = |x: Int, (bound, m): (Int, Int)| times(x, m) > times(bound, ticks);
        if least.is_some_and(|bound| is_below(way, bound))
            || most.is_some_and(|bound| is_above(way, bound))
        {
            break;
        }
        // A nth, with the digits of a ratio, towards zero, as is the part of the way, which is not beyond the highest.
        let share = (1 << SIGNAL) / ticks;
        let size = (times(share, way.abs()) >> SIGNAL).min(HIGHEST);
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
