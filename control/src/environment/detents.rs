//! Detents: a force that draws to the nearest of many places.

use super::{Reading, Refused, turn_of};
use crate::{Compliance, Force, Number, Si};

/// The finest pitch, rad (m).
pub(super) const FINEST: Si = Si::lit("0.001");
/// The coarsest pitch, rad (m): a turn has at least one.
pub(super) const COARSEST: Si = Si::lit("6.2831853072");

/// How far detents are apart.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spacing {
    /// This number of detents a turn, 1 to 6283: the same at every turn, bit for bit.
    PerTurn(u16),
    /// The distance between neighbours, rad (m), 0.001 to 6.283. It and its inverse are known to 2^-33; 100,000
    /// detents away that is some 1e-5 of a pitch.
    Pitch(Si),
}

/// The settings of detents.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DetentSettings {
    /// How far they are apart.
    pub spacing: Spacing,
    /// The largest force, N·m (N).
    pub strength: Si,
    /// Position of one of the detents, rad (m).
    pub centre: Si,
}

/// Detents: a force that is a triangle over the way. It is 0 where a device rests, largest a quarter of a pitch on
/// either side, and 0 again at the ridge between two detents.
///
/// It has no jump, so a device on a ridge does not chatter. It has no memory: over a whole pitch the work is 0, and
/// from a detent to the ridge it takes `A P/4`. The guard counts what sampling adds to that, as it does with walls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detents<N: Number> {
    place: Place,
    /// The strength `A`, as a factor of a whole signal.
    strength: Compliance<N>,
}

/// Positions of the detents.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    /// Detents of a turn: how many, and the place of one as a share of the way to the next, in 2^-32.
    Turn { per_turn: i32, centre: i32 },
    /// Detents along an axis: the inverse of the pitch, and the place of one.
    Axis { per_pitch: u64, centre: Si },
}

/// A quarter of a pitch, in 2^-32 of a pitch.
const QUARTER: u32 = 1 << 30;

/// The most in a turn: with the finest pitch.
pub(super) const MOST: u16 = 6283;

impl DetentSettings {
    /// Detents evenly around a turn: 1 to 6283 of them.
    #[must_use]
    pub const fn around_a_turn(per_turn: u16, strength: Si, centre: Si) -> Self {
        Self {
            spacing: Spacing::PerTurn(per_turn),
            strength,
            centre,
        }
    }

    /// Checks the settings, and computes the coefficients.
    ///
    /// # Errors
    /// A pitch from 0.001 to 6.283 rad is needed, or 1 to 6283 in a turn, and a force from 0 to the force limit.
    pub(super) fn detents<N: Number>(&self, limit: Si) -> Result<Detents<N>, Refused> {
        let place = match self.spacing {
            Spacing::PerTurn(per_turn) => {
                if per_turn == 0 || per_turn > MOST {
                    return Err(Refused::PerTurn(per_turn));
                }
                let per_turn = i32::from(per_turn);
                Place::Turn {
                    per_turn,
                    centre: turn_of(self.centre).wrapping_mul(per_turn),
                }
            }
            Spacing::Pitch(pitch) => {
                if pitch < FINEST || pitch > COARSEST {
                    return Err(Refused::Pitch(pitch));
                }
                // To the nearest: 2^64 over the pitch with its 32 digits.
                let pitch = u128::from(pitch.to_bits().unsigned_abs());
                let per_pitch = (1_u128 << 64)
                    .wrapping_add(pitch / 2)
                    .checked_div(pitch)
                    .unwrap_or_default();
                Place::Axis {
                    per_pitch: u64::try_from(per_pitch).unwrap_or_default(),
                    centre: self.centre,
                }
            }
        };
        let strength = (self.strength <= limit)
            .then(|| N::ratio(self.strength))
            .flatten()
            .ok_or(Refused::Strength {
                strength: self.strength,
                limit,
            })?;
        Ok(Detents {
            place,
            strength: Compliance(strength),
        })
    }
}

impl<N: Number> Detents<N> {
    /// The force against `+x` at a position: at most the strength, and the negative of that as far on the other side of the centre.
    #[inline]
    #[must_use]
    pub fn force(&self, at: &impl Reading<N>) -> Force<N> {
        let beyond = self.beyond(at);
        let size = beyond.unsigned_abs();
        let from_rest = if size <= QUARTER {
            size
        } else {
            QUARTER.wrapping_mul(2).wrapping_sub(size)
        };
        // A quarter of a pitch as one.
        let share = N::saturating_signal(Si::from_bits(i64::from(from_rest) << 2));
        let force = Force(N::scale(self.strength.0, share));
        if beyond < 0 { -force } else { force }
    }

    /// Distance beyond the nearest detent, as a share of the way to the next, in 2^-32.
    #[inline]
    fn beyond(&self, at: &impl Reading<N>) -> i32 {
        match self.place {
            Place::Turn { per_turn, centre } => {
                at.turn().wrapping_mul(per_turn).wrapping_sub(centre)
            }
            Place::Axis { per_pitch, centre } => along_axis(per_pitch, at.angle(), centre),
        }
    }
}

/// Same as [`Detents::beyond`], for detents that are set by a pitch. No board uses it: it needs a double word.
#[cold]
#[inline(never)]
fn along_axis(per_pitch: u64, angle: Si, centre: Si) -> i32 {
    let way = angle.saturating_sub(centre).to_bits();
    // The pitches since the centre, with 32 digits behind the point, of which only these are wanted.
    let pitches = way.unsigned_abs().wrapping_mul(per_pitch);
    let beyond = ((pitches >> 32) as u32).cast_signed();
    if way < 0 {
        beyond.wrapping_neg()
    } else {
        beyond
    }
}
