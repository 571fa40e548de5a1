//! Converts the encoder count to the penetration into a wall: the first step of each tick (control period). Every machine
//! calculates the penetration in integers.

use crate::number::Saturates as _;
use crate::{Number, Position, Si};

/// Fractional bits of the angle of one count. With 48 bits a turn of 40,000 counts is exact to 7.2e-11 rad.
const STEP_BITS: u32 = 48;
/// Number of fractional bits that the angle of one count has more than [`Si`].
const LOST: u32 = STEP_BITS - Si::FRAC_NBITS;
/// A turn in rad with 48 fractional bits: `round(2 π · 2^48)`.
const TURN: i64 = 1_768_559_438_007_110;

/// Converts an encoder's counts to angles relative to a wall's surface.
///
/// **Positions repeat exactly at every turn.** Counts are reduced to one turn before they are rounded. So after a whole turn
/// [`CountScale::turn`] gives the same bits, and [`CountScale::angle`] differs by exactly one rounded turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CountScale {
    /// Angle of one encoder count in rad, with [`STEP_BITS`] fractional bits.
    step: i64,
    surface: Si,
    /// Encoder counts per turn.
    counts: i64,
    /// One count as a fraction of a turn, in units of 2^-64, rounded to the nearest.
    share: u64,
    /// Angle of half a turn in rad. If a count lies at half a turn, this is that count's angle, so that both directions of rotation
    /// give the same value.
    half_turn: Si,
}

/// A count split into the nearest whole number of turns and the counts beyond them. A negative count is split by its absolute
/// value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Turned {
    turns: i64,
    /// Counts that remain beyond the whole turns, at most half a turn.
    rest: i64,
    /// Whether the count is negative.
    below: bool,
}

impl CountScale {
    /// Makes the scale of an encoder from its counts per turn (after quadrature decoding) and the angle of a wall's surface in rad.
    /// `None` for 0 counts.
    #[must_use]
    pub fn new(counts_per_rev: u32, surface: Si) -> Option<Self> {
        let counts = i64::from(counts_per_rev);
        let step = TURN.checked_add(counts / 2)?.checked_div(counts)?;
        // With one count per turn the fraction is 2^64, which does not fit; the largest value is close enough.
        let share = (1_u128 << 64)
            .checked_add(u128::from(counts_per_rev / 2))?
            .checked_div(u128::from(counts_per_rev))?;
        let scale = Self {
            step,
            surface,
            counts,
            share: u64::try_from(share).unwrap_or(u64::MAX),
            half_turn: Si::ZERO,
        };
        // With an odd number of counts per turn no count lies at half a turn: half a turn is rounded to the nearest.
        let half_turn = if counts % 2 == 0 {
            scale.within_turn(counts / 2)
        } else {
            Si::from_bits(nearest(TURN / 2))
        };
        Some(Self { half_turn, ..scale })
    }

    // Not inlined: the function is long, and the tick of an environment calls it twice.
    #[inline(never)]
    fn turned(&self, count: i64) -> Turned {
        let size = count.unsigned_abs();
        let shares = u128::from(size)
            .wrapping_mul(u128::from(self.share))
            .wrapping_add(1 << 63);
        let turns = ((shares >> 64) as i64).wrapping_abs();
        Turned {
            turns,
            rest: (size.cast_signed()).wrapping_sub(turns.wrapping_mul(self.counts)),
            below: count < 0,
        }
    }

    /// Angle in rad of a number of counts of at most half a turn, rounded to the nearest step of [`Si`].
    #[inline(always)]
    fn within_turn(&self, rest: i64) -> Si {
        let size = nearest(rest.wrapping_abs().wrapping_mul(self.step));
        Si::from_bits(if rest < 0 { size.wrapping_neg() } else { size })
    }

    /// Position of a count within its turn, as a fraction of the turn in units of 2^-32. A whole turn more gives the same value,
    /// and `-count` the negative value.
    #[inline]
    #[must_use]
    pub fn turn(&self, count: i64) -> i32 {
        let Turned { rest, below, .. } = self.turned(count);
        let share = rest.unsigned_abs().wrapping_mul(self.share);
        let size = (share.wrapping_add(1 << 31) >> 32) as u32;
        if (rest < 0) == below {
            size
        } else {
            size.wrapping_neg()
        }
        .cast_signed()
    }

    /// Distance in rad of a number of counts, rounded towards zero to a step of the number format; saturates.
    #[inline]
    #[must_use]
    pub fn moved<N: Number>(&self, counts: i64) -> Position<N> {
        // 32 turns, more than the number format of positions holds.
        let most = self.counts.wrapping_mul(32);
        let way = counts
            .min(most)
            .max(most.wrapping_neg())
            .wrapping_mul(self.step);
        // Rounds towards zero: a shift rounds down, so a negative number is first raised by the digits that the shift removes.
        let lost = way >> (i64::BITS - 1) & ((1 << LOST) - 1);
        let way = Si::from_bits(way.wrapping_add(lost) >> LOST);
        Position(N::saturating_signal(way))
    }

    /// The scale of the same encoder for a wall whose surface is at another angle, rad.
    #[inline(always)]
    #[must_use]
    pub fn before(self, surface: Si) -> Self {
        Self { surface, ..self }
    }

    /// Angle of a count in rad from count 0; the surface of the wall does not matter. `-count` gives the exact negative, and one
    /// turn more in counts gives exactly one turn more in angle.
    #[inline(never)]
    #[must_use]
    pub fn angle(&self, count: i64) -> Si {
        self.on_steps(count, Si::DELTA)
    }

    /// The angle of a count in rad, as a multiple of `step`, which is a power of two. Within a turn the angle is rounded to the
    /// nearest multiple; a whole turn counts as a whole number of steps.
    #[inline]
    #[must_use]
    pub fn on_steps(&self, count: i64, step: Si) -> Si {
        let Turned { turns, rest, below } = self.turned(count);
        let half = on_step(self.half_turn, step).to_bits();
        let whole = Si::from_bits(turns.saturating_mul(half.wrapping_mul(2)));
        let size = whole.saturating_add(on_step(self.within_turn(rest), step));
        if below { size.saturating_neg() } else { size }
    }

    /// Same as [`CountScale::penetration`], for a wall surface at `turns` whole turns plus the angle `surface`.
    #[inline(always)]
    #[must_use]
    pub fn penetration_from<N: Number>(&self, turns: i32, surface: Si, count: i64) -> Position<N> {
        let from = i64::from(turns).wrapping_mul(self.counts);
        self.behind(surface, count.saturating_sub(from))
    }

    /// Penetration of an encoder count into the wall, `2π count / counts_per_rev - surface` in rad. It is rounded down to a step of
    /// the number format and saturates.
    ///
    /// Angles reach ±32,767 rad before the calculation itself saturates.
    #[inline]
    #[must_use]
    pub fn penetration<N: Number>(&self, count: i64) -> Position<N> {
        self.behind(self.surface, count)
    }

    #[inline(always)]
    fn behind<N: Number>(&self, surface: Si, count: i64) -> Position<N> {
        let angle = Si::from_bits(count.saturating_mul(self.step) >> (STEP_BITS - Si::FRAC_NBITS));
        let penetration = Si::from_bits(angle.to_bits().difference(surface.to_bits()));
        Position(N::saturating_signal(penetration))
    }
}

/// Rounds an angle to the nearest multiple of `step`, a power of two. The negative angle gives the exact negative.
#[inline(always)]
pub(crate) fn on_step(angle: Si, step: Si) -> Si {
    let bits = angle.to_bits();
    let near = |size: i64| size.wrapping_add(step.to_bits() >> 1) & step.to_bits().wrapping_neg();
    Si::from_bits(if bits < 0 {
        near(bits.wrapping_neg()).wrapping_neg()
    } else {
        near(bits)
    })
}

/// Rounds an angle from [`STEP_BITS`] fractional bits to those of [`Si`], to the nearest.
const fn nearest(size: i64) -> i64 {
    size.wrapping_add(1 << (LOST - 1)) >> LOST
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Fixed32;

    #[test]
    fn the_turn_is_two_pi() {
        assert_eq!(
            TURN,
            (core::f64::consts::TAU * 2f64.powi(48)).round() as i64
        );
    }

    #[test]
    fn a_count_is_its_angle_and_the_end_of_the_range_saturates() {
        let scale = CountScale::new(40_000, Si::lit("0.5")).unwrap();
        for count in [-4_000_000_i64, -3_183, 0, 1, 3_183, 3_184, 40_000, 700_000] {
            let exact = core::f64::consts::TAU * count as f64 / 40_000.0 - 0.5;
            let shown: f64 = scale.penetration::<Fixed32>(count).0.to_num();
            let expected = exact.clamp(-128.0, 128.0);
            assert!(
                (shown - expected).abs() < 1.2e-7,
                "{count}: {shown} for {expected}"
            );
        }
        assert_eq!(
            scale.penetration::<Fixed32>(i64::MAX).0,
            fixed::types::I8F24::MAX
        );
        assert_eq!(
            scale.penetration::<Fixed32>(i64::MIN).0,
            fixed::types::I8F24::MIN
        );
        assert_eq!(CountScale::new(0, Si::ZERO), None);
    }

    #[test]
    fn a_count_is_the_same_at_every_turn() {
        for counts in [4_u32, 5, 4_096, 16_384, 40_000, 99_999, 1_000_000] {
            let scale = CountScale::new(counts, Si::ZERO).unwrap();
            let counts = i64::from(counts);
            let near = (-counts / 2)..=(counts / 2);
            // All counts that are half a turn away or next to it, and some in between.
            let some = near.step_by((counts as usize / 97).max(1));
            for rest in some.chain([counts / 2, -(counts / 2), counts / 2 - 1, 1 - counts / 2]) {
                let exact = core::f64::consts::TAU * rest as f64 / counts as f64;
                let angle = scale.angle(rest);
                assert!((angle.to_num::<f64>() - exact).abs() < 2f64.powi(-32) + 1e-14);
                assert_eq!(scale.angle(-rest), -angle);
                assert_eq!(scale.turn(-rest), scale.turn(rest).wrapping_neg());
                for turns in [1_i64, -1, 10_000, -10_000, 340_000, -340_000] {
                    let there = rest + turns * counts;
                    assert_eq!(
                        scale.turn(there),
                        scale.turn(rest),
                        "{counts} {rest} {turns}"
                    );
                    for step in [Si::DELTA, Si::from_bits(1 << 8), Si::from_bits(1 << 18)] {
                        let turn = 2 * on_step(scale.half_turn, step);
                        let whole = Si::from_bits(turns * turn.to_bits());
                        let expected = whole + scale.on_steps(rest, step);
                        assert_eq!(scale.on_steps(there, step), expected, "{counts} {rest}");
                        assert!((scale.on_steps(rest, step) - angle).abs() <= step);
                    }
                }
            }
            assert!(
                (scale.half_turn.to_num::<f64>() - core::f64::consts::PI).abs() < 2f64.powi(-32)
            );
        }
    }

    #[test]
    fn a_way_is_that_of_its_counts_and_ends_with_the_format() {
        let scale = CountScale::new(40_000, Si::lit("0.5")).unwrap();
        for counts in [0_i64, 1, 3, 25, 39_999, 700_000] {
            let exact = core::f64::consts::TAU * counts as f64 / 40_000.0;
            let way: Position<Fixed32> = scale.moved(counts);
            let lost = exact - way.0.to_num::<f64>();
            assert!((-1e-12..2f64.powi(-24)).contains(&lost), "{counts}: {lost}");
            assert_eq!(scale.moved::<Fixed32>(-counts), -way);
        }
        assert_eq!(scale.moved::<Fixed32>(i64::MAX).0, fixed::types::I8F24::MAX);
        assert_eq!(scale.moved::<Fixed32>(i64::MIN).0, fixed::types::I8F24::MIN);
    }
}
