//! Detents: a force that draws to the nearest of many places.

use super::Refused;
use crate::{Compliance, Force, Number, Si};

/// The finest pitch, rad (m).
pub(super) const FINEST: Si = Si::lit("0.001");
/// The coarsest pitch, rad (m): a turn has at least one.
pub(super) const COARSEST: Si = Si::lit("6.2831853072");

/// What a person sets of detents.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DetentSettings {
    /// From one to the next, rad (m).
    pub pitch: Si,
    /// The largest force, N·m (N).
    pub strength: Si,
    /// Where one of them is, rad (m).
    pub centre: Si,
}

/// A force that is a triangle over the way: 0 where a device rests, its largest a quarter of a pitch on either side, 0 again at
/// the ridge between two of them. It has no jump, so that a device on a ridge does not chatter, and no memory: over a whole pitch the work
/// is 0, and out of a detent it takes `A P/4` to the ridge. What sampling adds to that, the guard counts as it does with walls.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detents<N: Number> {
    /// `1/P`.
    per_pitch: u64,
    centre: Si,
    /// `A`, as what a whole signal is multiplied with.
    strength: Compliance<N>,
}

/// Of a pitch, as its fraction of `2^32`.
const QUARTER: u32 = 1 << 30;

/// A turn, in 2^-64 rad.
const TURN: u128 = 0x6_487e_d511_0b46_11a6;

impl DetentSettings {
    /// Evenly around a turn, of 1 to 6283 of them.
    #[must_use]
    pub fn around_a_turn(per_rev: u32, strength: Si, centre: Si) -> Self {
        let per_rev = u128::from(per_rev.max(1));
        // To the nearest of the 2^-32 rad of a setting.
        let pitch = TURN.saturating_add(per_rev << 31) / (per_rev << 32);
        Self {
            pitch: Si::from_bits(i64::try_from(pitch).unwrap_or(i64::MAX)),
            strength,
            centre,
        }
    }

    /// Checks the settings, and computes the coefficients.
    ///
    /// # Errors
    /// A pitch from 0.001 to 6.283 rad is needed, and a force from 0 to the force limit.
    pub(super) fn detents<N: Number>(&self, limit: Si) -> Result<Detents<N>, Refused> {
        if self.pitch < FINEST || self.pitch > COARSEST {
            return Err(Refused::Pitch(self.pitch));
        }
        let strength = (self.strength <= limit)
            .then(|| N::ratio(self.strength))
            .flatten()
            .ok_or(Refused::Strength {
                strength: self.strength,
                limit,
            })?;
        // To the nearest: 2^64 over the pitch with its 32 digits.
        let pitch = u128::from(self.pitch.to_bits().unsigned_abs());
        let per_pitch = (1_u128 << 64)
            .wrapping_add(pitch / 2)
            .checked_div(pitch)
            .unwrap_or_default();
        Ok(Detents {
            per_pitch: u64::try_from(per_pitch).unwrap_or_default(),
            centre: self.centre,
            strength: Compliance(strength),
        })
    }
}

impl<N: Number> Detents<N> {
    /// The force against `+x` at an angle: at most the strength, and the negative of that as far on the other side of the centre.
    #[inline]
    #[must_use]
    pub fn force(&self, angle: Si) -> Force<N> {
        let way = angle.saturating_sub(self.centre).to_bits();
        // The pitches since the centre, with 32 digits behind the point, of which only these are wanted.
        let pitches = way.unsigned_abs().wrapping_mul(self.per_pitch);
        let beyond = ((pitches >> 32) as u32).cast_signed();
        let size = beyond.unsigned_abs();
        let from_rest = if size <= QUARTER {
            size
        } else {
            QUARTER.wrapping_mul(2).wrapping_sub(size)
        };
        // A quarter of a pitch as one.
        let share = N::saturating_signal(Si::from_bits(i64::from(from_rest) << 2));
        let force = Force(N::scale(self.strength.0, share));
        if (way < 0) == (beyond < 0) {
            force
        } else {
            -force
        }
    }
}
