//! A wall's surface on an axis, and what a measured position is before it.

use crate::{CountScale, Force, Number, Position, Si};

crate::choice! {
    /// On which side of its surface a wall is solid.
    Side {
        /// At larger angles: it pushes towards smaller ones.
        #[default]
        Above = "above",
        /// At smaller angles: it pushes towards larger ones.
        Below = "below",
    }
}

impl Side {
    /// A force along the axis as this wall sees it, or back.
    #[inline(always)]
    #[must_use]
    pub fn seen<N: Number>(self, force: Force<N>) -> Force<N> {
        match self {
            Self::Above => force,
            Self::Below => -force,
        }
    }
}

/// Where a wall begins.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Face {
    /// `x_s`, rad (m).
    pub surface: Si,
    /// On which side it is solid.
    pub side: Side,
}

/// A measured position. That of the mirrored position must be the mirror image, to the bit.
pub trait Reading<N: Number> {
    /// Along the axis, rad (m).
    fn angle(&self) -> Si;
    /// How deep it lies behind a face, positive inside.
    fn penetration(&self, face: &Face) -> Position<N>;
}

/// A count of an encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Counted {
    /// The encoder, before whatever surface.
    pub scale: CountScale,
    /// Its count.
    pub count: i64,
}

impl<N: Number> Reading<N> for Counted {
    #[inline(always)]
    fn angle(&self) -> Si {
        self.scale.angle(self.count)
    }

    #[inline(always)]
    fn penetration(&self, face: &Face) -> Position<N> {
        let (surface, count) = match face.side {
            Side::Above => (face.surface, self.count),
            Side::Below => (face.surface.saturating_neg(), self.count.saturating_neg()),
        };
        self.scale.before(surface).penetration(count)
    }
}
