//! Detents: a force that pulls the device to the nearest of many evenly spaced positions.

use super::{Reading, Refused, turn_of};
use crate::{Compliance, Force, Number, Si};

/// The smallest distance between detents, rad (m).
pub(super) const FINEST: Si = Si::lit("0.001");
/// The largest distance between detents, rad (m): at least one detent per turn.
pub(super) const COARSEST: Si = Si::lit("6.2831853072");

/// The distance between neighbouring detents.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Spacing {
    /// This number of detents per turn, 1 to 6283. Their positions are the same at every turn, bit for bit.
    PerTurn(u16),
    /// The distance between neighbours (pitch), rad (m), 0.001 to 6.283. The pitch in rad and its inverse each have a rounding
    /// error of up to 2^-33. So after 100,000 detents the position can be wrong by some 2e-5 of a pitch of 1 rad, or 1 % of a pitch
    /// of 0.001 rad.
    Pitch(Si),
}

/// The settings of detents.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DetentSettings {
    /// The distance between neighbouring detents.
    pub spacing: Spacing,
    /// The largest force, N·m (N).
    pub strength: Si,
    /// Position of one of the detents, rad (m).
    pub centre: Si,
}

/// Detents whose force over the position is a triangle wave. The force is 0 at a detent, where the device rests. It is largest a
/// quarter of a pitch (distance between detents) to either side, and 0 again halfway between two detents.
///
/// The force has no jump, so a device halfway between two detents does not chatter. It depends on the position alone: the work
/// over a whole pitch is 0, and from a detent to the halfway point it is `A P/4` (largest force `A`, pitch `P`). Sampling the
/// position adds energy, as with walls; the energy guard counts that energy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detents<N: Number> {
    ring: Ring,
    /// The largest force of the detents, as a factor that turns the triangle wave into a force.
    strength: Compliance<N>,
}

/// Evenly spaced positions, around a turn or along an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Ring {
    /// Positions around a turn: their number per turn, and the angle of one of them modulo the distance between neighbours, in
    /// units of 2^-32 of that distance.
    Turn { per_turn: i32, centre: i32 },
    /// Positions along an axis: 2^32 over the distance between neighbours in rad (m), and one of the positions.
    Axis { per_pitch: u64, centre: Si },
}

/// A quarter of the distance between two detents (pitch), in units of 2^-32 of that distance.
const QUARTER: u32 = 1 << 30;

/// The most detents per turn: with more, the distance between detents would be below the smallest allowed one.
pub(super) const MOST: u16 = 6283;

impl DetentSettings {
    /// Settings of 1 to 6283 detents evenly around a turn, with the largest force in N·m and the angle of one detent in rad.
    #[must_use]
    pub const fn around_a_turn(per_turn: u16, strength: Si, centre: Si) -> Self {
        Self {
            spacing: Spacing::PerTurn(per_turn),
            strength,
            centre,
        }
    }

    /// Checks the settings, and computes the coefficients. `limit` is the force limit in N·m.
    ///
    /// # Errors
    /// The distance between detents is outside 0.001 to 6.283 rad, their number per turn is outside 1 to 6283, or the largest force
    /// is outside 0 to the force limit.
    pub(super) fn detents<N: Number>(&self, limit: Si) -> Result<Detents<N>, Refused> {
        let ring = Ring::new(self.spacing, self.centre)?;
        let strength = (self.strength <= limit)
            .then(|| N::ratio(self.strength))
            .flatten()
            .ok_or(Refused::Strength {
                strength: self.strength,
                limit,
            })?;
        Ok(Detents {
            ring,
            strength: Compliance(strength),
        })
    }
}

impl<N: Number> Detents<N> {
    /// The detents' force at a position, positive against `+x` and at most the largest force of the settings. At the mirrored
    /// position about a detent's centre the force is the exact negative.
    #[inline]
    #[must_use]
    pub fn force(&self, at: &impl Reading<N>) -> Force<N> {
        let beyond = self.ring.beyond(at);
        let size = beyond.unsigned_abs();
        let from_rest = if size <= QUARTER {
            size
        } else {
            QUARTER.wrapping_mul(2).wrapping_sub(size)
        };
        // The distance as a fraction of a quarter of the pitch.
        let share = N::saturating_signal(Si::from_bits(i64::from(from_rest) << 2));
        let force = Force(N::scale(self.strength.0, share));
        if beyond < 0 { -force } else { force }
    }
}

impl Ring {
    /// Checks the distance between positions and computes the coefficients; `centre` is one of the positions.
    pub(super) fn new(spacing: Spacing, centre: Si) -> Result<Self, Refused> {
        match spacing {
            Spacing::PerTurn(per_turn) => {
                if per_turn == 0 || per_turn > MOST {
                    return Err(Refused::PerTurn(per_turn));
                }
                let per_turn = i32::from(per_turn);
                Ok(Self::Turn {
                    per_turn,
                    centre: turn_of(centre).wrapping_mul(per_turn),
                })
            }
            Spacing::Pitch(pitch) => {
                if pitch < FINEST || pitch > COARSEST {
                    return Err(Refused::Pitch(pitch));
                }
                // Calculates 2^64 over the pitch, which has 32 fractional bits, rounded to the nearest.
                let pitch = u128::from(pitch.to_bits().unsigned_abs());
                let per_pitch = (1_u128 << 64)
                    .wrapping_add(pitch / 2)
                    .checked_div(pitch)
                    .unwrap_or_default();
                Ok(Self::Axis {
                    per_pitch: u64::try_from(per_pitch).unwrap_or_default(),
                    centre,
                })
            }
        }
    }

    /// Signed distance from the nearest position, as a fraction of the distance between positions, in units of 2^-32.
    #[inline]
    pub(super) fn beyond<N: Number>(&self, at: &impl Reading<N>) -> i32 {
        match *self {
            Self::Turn { per_turn, centre } => {
                at.turn().wrapping_mul(per_turn).wrapping_sub(centre)
            }
            Self::Axis { per_pitch, centre } => along_axis(per_pitch, at.angle(), centre),
        }
    }
}

/// Same as [`Ring::beyond`], for positions whose distance is set as an angle. The calculation needs 64-bit arithmetic, so a
/// separate function keeps the usual path fast.
#[cold]
#[inline(never)]
fn along_axis(per_pitch: u64, angle: Si, centre: Si) -> i32 {
    let way = angle.saturating_sub(centre).to_bits();
    // Number of pitches from the centre with 32 fractional bits; only the fractional bits are needed.
    let pitches = way.unsigned_abs().wrapping_mul(per_pitch);
    let beyond = ((pitches >> 32) as u32).cast_signed();
    if way < 0 {
        beyond.wrapping_neg()
    } else {
        beyond
    }
}
