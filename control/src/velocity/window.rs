//! First-order adaptive windowing: Janabi-Sharifi, Hayward and Chen, IEEE TCST 8(6) 1003, 2000, with the line through both ends.

use crate::{Number, Position, Ratio, Stiffness};

/// Positions that a window reaches back at most.
pub const LONGEST_WINDOW: usize = 16;

/// A number of ticks, as a factor and as a divisor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slope<N: Number> {
    /// Length of the window, ticks: `n`.
    pub times: Stiffness<N>,
    /// Share: `1/n`.
    pub share: Ratio<N>,
}

/// The slope over the longest usable window: one in which a straight line from its first to its last position passes
/// every position between by no more than `d`. So the window is long, and quiet, while the motion is even; it is
/// short, and quick, when the motion turns.
///
/// Each position is tested once: the slope must lie in the cone that all nearer positions allow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstOrderAdaptiveWindow<N: Number> {
    /// The windows, shortest first.
    pub slopes: [Slope<N>; LONGEST_WINDOW],
    /// Ticks of the longest window.
    pub longest: u8,
    /// `d`: how far a position may be from the line. Both ends and what lies between are right to half a count.
    pub margin: Position<N>,
}

/// A bound on a slope: a distance and the number of ticks it takes.
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
            // As products, without a quotient: `way/n` against `bound/m`.
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
