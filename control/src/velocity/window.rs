//! Velocity by first-order adaptive windowing, Janabi-Sharifi, Hayward and Chen, IEEE TCST 8(6) 1003, 2000. The fitted line goes
//! through the first and the last position of the window.

use crate::{Number, Position, Ratio, Stiffness};

/// The most past positions that a window holds.
pub const LONGEST_WINDOW: usize = 16;

/// The length of a window in ticks and its inverse, in the number formats in which the slope over it is calculated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slope<N: Number> {
    /// Length of the window, ticks.
    pub times: Stiffness<N>,
    /// Inverse of the window's length, 1/ticks.
    pub share: Ratio<N>,
}

/// Velocity as the slope over the longest usable window of past positions. In such a window a straight line from the first to the
/// last position passes every position between them by no more than `margin`. So the window is long, with little noise, while the
/// motion is even. It is short, and follows fast, when the motion turns.
///
/// Each position is tested once: the slope to that position must lie within the bounds that all more recent positions allow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstOrderAdaptiveWindow<N: Number> {
    /// The lengths of the possible windows, shortest first.
    pub slopes: [Slope<N>; LONGEST_WINDOW],
    /// Length of the longest window, ticks.
    pub longest: u8,
    /// Largest allowed distance of a position from the line through the window's first and last position: one count plus rounding,
    /// because each position has an error of at most half a count.
    pub margin: Position<N>,
}

/// A bound on a slope, kept as a distance and the number of ticks over which it is measured.
type Bound<N> = Option<(Position<N>, Stiffness<N>)>;

impl<N: Number> FirstOrderAdaptiveWindow<N> {
    /// Runs one control period; returns the displacement per tick.
    #[inline]
    pub fn tick(&self, past: &mut [Position<N>; LONGEST_WINDOW], at: Position<N>) -> Position<N> {
        let (mut least, mut most): (Bound<N>, Bound<N>) = (None, None);
        let mut moved = Position::zero();
        let slopes = self.slopes.iter().take(usize::from(self.longest));
        for (before, slope) in past.iter().zip(slopes) {
            let way = at - *before;
            // Compares the slopes `way/n` and `bound/m` as products, without a division.
            let above =
                |(bound, ticks): (Position<N>, Stiffness<N>)| ticks * way > slope.times * bound;
            let below =
                |(bound, ticks): (Position<N>, Stiffness<N>)| ticks * way < slope.times * bound;
            if least.is_some_and(below) || most.is_some_and(above) {
                break;
            }
            moved = slope.share * way;
            let (low, high) = (way - self.margin, way + self.margin);
            let tighter = |(bound, ticks)| ticks * low > slope.times * bound;
            if least.is_none_or(tighter) {
                least = Some((low, slope.times));
            }
            let tighter = |(bound, ticks)| ticks * high < slope.times * bound;
            if most.is_none_or(tighter) {
                most = Some((high, slope.times));
            }
        }
        let mut carried = at;
        for place in past {
            core::mem::swap(place, &mut carried);
        }
        moved
    }
}
