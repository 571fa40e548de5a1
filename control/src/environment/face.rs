//! The surface of a wall on one axis, and the penetration of a measured position into the wall.

use crate::encoder::on_step;
use crate::{CountScale, Force, Number, Position, Si};

crate::choice! {
    /// The side of a wall's surface on which the wall is solid.
    Side {
        /// The wall is solid at angles above its surface: it pushes towards smaller angles.
        #[default]
        Above = "above",
        /// The wall is solid at angles below its surface: it pushes towards larger angles.
        Below = "below",
    }
}

impl Side {
    /// Converts a force out of the wall to a force against `+x`, and back. The sign changes for a wall that is solid below its
    /// surface.
    #[inline(always)]
    #[must_use]
    pub fn seen<N: Number>(self, force: Force<N>) -> Force<N> {
        match self {
            Self::Above => force,
            Self::Below => -force,
        }
    }
}

/// Position and solid side of a wall's surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Face {
    /// Position of the wall's surface, rad (m).
    pub surface: Si,
    /// The side of the surface on which the wall is solid.
    pub side: Side,
}

/// A surface whose angle is split into whole turns and the rest. The number format of positions ends at ±128 rad. The split lets
/// positions be measured relative to a surface further away.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reached {
    /// Whole turns from zero; 0 for a surface within ±100 rad.
    pub turns: i32,
    /// The surface at the angle that remains beyond the whole turns, with its solid side.
    pub face: Face,
}

/// A surface within this angle of zero, rad, is measured from zero; a surface further away is measured from a number of whole
/// turns.
const FROM_ZERO: Si = Si::lit("100");

/// A turn in rad with 64 fractional bits.
const TURN: u128 = 0x6_487e_d511_0b46_11a6;

impl Face {
    /// Splits the surface's angle into the nearest number of whole turns and the rest, if it is more than `FROM_ZERO` from zero.
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
        // An angle is at most 2^31 rad and a turn more than 6 rad, so the number of turns fits 32 bits.
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

/// Position of an angle within its turn, as a fraction of the turn in units of 2^-32. The negative angle gives the exact negative.
#[must_use]
pub fn turn_of(angle: Si) -> i32 {
    // The number of turns per radian in units of 2^-64 (2^64/2π), rounded to the nearest.
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

/// A measured position of the device. For the position mirrored at 0, every method must give exactly the negative value, bit for
/// bit; `penetration` must give the same value for the mirrored wall.
pub trait Reading<N: Number> {
    /// Position along the axis, rad (m).
    fn angle(&self) -> Si;
    /// The position within its turn, as a fraction of the turn in units of 2^-32; see [`turn_of`].
    #[inline]
    fn turn(&self) -> i32 {
        turn_of(self.angle())
    }
    /// The angle rounded to the nearest multiple of `step`, a power of two.
    #[inline]
    fn on_steps(&self, step: Si) -> Si {
        on_step(self.angle(), step)
    }
    /// Depth of the position behind a surface, positive inside the wall.
    fn penetration(&self, reached: &Reached) -> Position<N>;
}

/// A position measured by an encoder, as a count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Counted {
    /// The conversion from the encoder's counts to angles. The wall surface that belongs to a [`CountScale`] is not used.
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
