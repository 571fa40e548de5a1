//! Specification of a velocity filter: first-order adaptive windowing of Janabi-Sharifi, Hayward and Chen, IEEE TCST 8(6) 1003,
//! 2000, with the line through both ends of the window.

use super::{HIGHEST, Int, SIGNAL, signal, times};

/// Most past positions in a window of the velocity filter.
pub const LONGEST: usize = 16;

/// A bound on a slope: a distance and the number of ticks by which it is divided; `None` if there is no bound.
type Bound = Option<(Int, Int)>;

/// The slope of the longest window of up to `longest` ticks in which a line through the first and last position passes all other
/// positions within the margin. `past` holds earlier measured positions, the latest first.
#[must_use]
pub fn window(past: &[Int; LONGEST], at: Int, longest: usize, margin: Int) -> Int {
    let (mut least, mut most): (Bound, Bound) = (None, None);
    let mut slope = 0;
    for n in 1..=longest.min(LONGEST) {
        let ticks = n as Int;
        let way = signal(at - past[n - 1]);
        // Quotients are compared by products: way/n with bound/m.
        let is_below = |x: Int, (bound, m): (Int, Int)| times(x, m) < times(bound, ticks);
        let is_above = |x: Int, (bound, m): (Int, Int)| times(x, m) > times(bound, ticks);
        if least.is_some_and(|bound| is_below(way, bound))
            || most.is_some_and(|bound| is_above(way, bound))
        {
            break;
        }
        // The nth part of the distance, as a product with the ratio 1/n. Ratio and product are rounded towards zero, and the
        // product is limited to the highest signal.
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
