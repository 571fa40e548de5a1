//! What a law gets in one tick: from the encoder, from a filter of velocity, or from the state estimator.

use crate::{Number, Position};

/// Input of a law in one tick: position and displacement, measured or estimated for the time at which the law's force will act.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sample<N: Number> {
    /// Penetration into the wall: position less the surface's position, positive inside.
    pub e: Position<N>,
    /// Displacement since the last tick, positive inward. An estimated displacement is the velocity times the tick.
    pub moved: Position<N>,
}

impl<N: Number> Sample<N> {
    /// Makes a sample from measurements: the displacement is the difference of two penetrations.
    #[inline(always)]
    #[must_use]
    pub fn measured(e: Position<N>, last: Position<N>) -> Self {
        Self { e, moved: e - last }
    }

    /// The part of the displacement that lies inside the wall, for laws whose memory ends at the surface.
    #[inline(always)]
    #[must_use]
    pub fn moved_inside(self) -> Position<N> {
        self.moved.min(self.e)
    }
}
