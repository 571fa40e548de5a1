//! A wall's surface on an axis, and the penetration of a measured position.

use crate::encoder::on_step;
use crate::{CountScale, Force, Number, Position, Si};

crate::choice! {
    /// The side of its surface on which a wall is solid.
    Side {
        /// Solid at larger angles: it pushes towards smaller ones.
        #[default]
        Above = "above",
        /// Solid at smaller angles: it pushes towards larger ones.
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
    /// The side on which it is solid.
    pub side: Side,
}

/// A surface that positions do not reach from zero is measured from a whole number of turns on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reached {
    /// Whole turns; 0 for a surface up to `FROM_ZERO`.
    pub turns: i32,
    /// The part of the surface's angle beyond the whole turns.
    pub face: Face,
}

/// Up to such an angle, to either side, a surface is measured from zero, as that of a wall alone.
const FROM_ZERO: Si = Si::lit("100");

/// A turn, in 2^-64 rad.
const TURN: u128 = 0x6_487e_d511_0b46_11a6;

impl Face {
    /// The turn from which on it is measured.
    #[must_use]
    pub fn reached(self) -> Reached {
        if self.surface.saturating_abs() <= FROM_ZERO {
            return Reached {
                turns: 0,
                face: self,
            };
        }
        let size = u128::from(self.surface.to_bits().unsigned_abs()) << Si::FRAC_NBITS;
        let turns = size.wrapping_add(TURN / 2) / TURN;
        let whole = turns.wrapping_mul(TURN).wrapping_add(1 << 31) >> Si::FRAC_NBITS;
        // An angle has at most 2^31 rad, and a turn more than 6.
        let (turns, whole) = (turns as i32, Si::from_bits(whole as i64));
        let (turns, whole) = if self.surface < Si::ZERO {
            (turns.wrapping_neg(), whole.saturating_neg())
        } else {
            (turns, whole)
        };
        let surface = self.surface.saturating_sub(whole);
        Reached {
            turns,
            face: Self { surface, ..self },
        }
    }
}

/// Where in its turn an angle is, as a share of the turn in 2^-32: that of the mirrored angle is its negative.
#[must_use]
pub fn turn_of(angle: Si) -> i32 {
    // 2^64/2π, to the nearest.
    const PER_RADIAN: u128 = 0x28be_60db_9391_054a;
    let shares = u128::from(angle.to_bits().unsigned_abs())
        .wrapping_mul(PER_RADIAN)
        .wrapping_add(1 << 63);
    let size = (shares >> 64) as u32;
    if angle < Si::ZERO {
        size.wrapping_neg()
    } else {
        size
    }
    .cast_signed()
}

/// A measured position. That of the mirrored position must be the mirror image, bit for bit.
pub trait Reading<N: Number> {
    /// Along the axis, rad (m).
    fn angle(&self) -> Si;
    /// Where in its turn that is: [`turn_of`].
    #[inline]
    fn turn(&self) -> i32 {
        turn_of(self.angle())
    }
    /// The angle to the nearest of such steps, a power of two.
    #[inline]
    fn on_steps(&self, step: Si) -> Si {
        on_step(self.angle(), step)
    }
    /// How deep it lies behind a face, positive inside.
    fn penetration(&self, reached: &Reached) -> Position<N>;
}

/// A count of an encoder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Counted {
    /// The encoder, before whatever surface.
    pub scale: CountScale,
    /// The encoder's count.
    pub count: i64,
}

impl<N: Number> Reading<N> for Counted {
    #[inline(always)]
    fn angle(&self) -> Si {
        self.scale.angle(self.count)
    }

    #[inline(always)]
    fn on_steps(&self, step: Si) -> Si {
        self.scale.on_steps(self.count, step)
    }

    #[inline(always)]
    fn turn(&self) -> i32 {
        self.scale.turn(self.count)
    }

    #[inline(always)]
    fn penetration(&self, Reached { turns, face }: &Reached) -> Position<N> {
        let (turns, surface, count) = match face.side {
            Side::Above => (*turns, face.surface, self.count),
            Side::Below => (
                turns.wrapping_neg(),
                face.surface.saturating_neg(),
                self.count.saturating_neg(),
            ),
        };
        self.scale.penetration_from(turns, surface, count)
    }
}
