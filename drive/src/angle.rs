//! Electrical angle of a motor as a fraction of a turn, with sine and cosine from a table.

/// An angle as a `u16` fraction of a turn: 0x4000 is a quarter turn, and the value wraps to zero after a full turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Angle(
    /// The angle in 1/65,536 of a turn.
    pub u16,
);

/// Number of steps of the sine table per turn.
const STEPS: usize = 256;
/// Number of low bits of a 16-bit angle that lie between two steps of the sine table and are interpolated.
const STEP_BITS: u32 = 8;
/// Sine table. It has one entry more than a turn needs, so that the interpolation always finds a next entry.
const TABLE: [i16; STEPS + 1] = table();

/// `2 π` with 60 fractional bits.
const TWO_PI: i128 = 7_244_019_458_077_122_842;
/// Number of fractional bits with which the compiler calculates the sine table.
const BITS: u32 = 60;

/// Calculates the sine table in 1/32,768, rounded to the nearest, with 1 as 32,767: entry `k` is `sin(2π k / 256)`. The compiler
/// evaluates the power series.
const fn table() -> [i16; STEPS + 1] {
    let mut table = [0; STEPS + 1];
    let mut k = 0;
    while k <= STEPS {
        // Reduces the angle to a quarter turn around zero, where the power series needs few terms: sin(π - x) = sin x.
        let (turn, sign) = if k > STEPS / 2 {
            (k - STEPS / 2, -1)
        } else {
            (k, 1)
        };
        let folded = if turn > STEPS / 4 {
            STEPS / 2 - turn
        } else {
            turn
        };
        let x = (TWO_PI * folded as i128) >> 8;
        let square = (x * x) >> BITS;
        let (mut term, mut sum, mut n) = (x, x, 1);
        while n < 12 {
            term = -((term * square) >> BITS) / ((2 * n) * (2 * n + 1));
            sum += term;
            n += 1;
        }
        let rounded = (sum + (1 << (BITS - 16))) >> (BITS - 15);
        let limited = if rounded > 32_767 { 32_767 } else { rounded };
        table[k] = (sign * limited) as i16;
        k += 1;
    }
    table
}

impl Angle {
    /// A quarter of an electrical turn.
    pub const QUARTER: Self = Self(0x4000);

    /// Sine in 1/32,768, interpolated linearly between 256 entries. The error is at most 4/32,768 (1.3e-4).
    #[inline]
    #[must_use]
    pub const fn sin(self) -> i32 {
        let at = (self.0 >> STEP_BITS) as usize;
        let rest = (self.0 & ((1 << STEP_BITS) - 1)) as i32;
        // The indices are always in range: `at` has 8 bits and the table 257 entries.
        let (from, to) = (TABLE[at] as i32, TABLE[at + 1] as i32);
        from + (((to - from) * rest + (1 << (STEP_BITS - 1))) >> STEP_BITS)
    }

    /// Cosine in 1/32,768, calculated like [`Angle::sin`].
    #[inline]
    #[must_use]
    pub const fn cos(self) -> i32 {
        self.plus(Self::QUARTER).sin()
    }

    /// Sum of the two angles, wrapping at a turn.
    #[inline]
    #[must_use]
    pub const fn plus(self, other: Self) -> Self {
        Self(self.0.wrapping_add(other.0))
    }

    /// Signed angle from `other` to this angle, in 1/65,536 of a turn, by the shorter way: -32,768 to 32,767.
    #[inline]
    #[must_use]
    pub const fn since(self, other: Self) -> i16 {
        self.0.wrapping_sub(other.0).cast_signed()
    }
}

/// Converts encoder counts to the electrical angle. It is exact to 2^-64 turns per count, so no error builds up over many turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ElectricalScale {
    /// Electrical turns per encoder count in units of 2^-64 turn: `2^64 · pole pairs/counts per turn`, wrapping at 2^64.
    per_count: u64,
}

impl ElectricalScale {
    /// Makes the scale from a motor's pole pairs and an encoder's counts per turn; 0 counts are treated as 1.
    #[must_use]
    pub const fn new(pole_pairs: u8, counts_per_rev: u32) -> Self {
        let counts = if counts_per_rev == 0 {
            1
        } else {
            counts_per_rev as u64
        };
        // Divides 32 bits at a time: the remainder is below 2^32 and is divided again.
        let turns = (pole_pairs as u64) << 32;
        let (upper, rest) = (turns / counts, turns % counts);
        Self {
            per_count: (upper << 32).wrapping_add((rest << 32) / counts),
        }
    }

    /// The electrical angle at an encoder count, relative to the angle at count 0.
    #[inline]
    #[must_use]
    pub const fn angle(&self, count: i64) -> Angle {
        Angle((count.cast_unsigned().wrapping_mul(self.per_count) >> 48) as u16)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_angle_has_its_sine_and_cosine() {
        let mut worst = 0.0_f64;
        for bits in 0..=u16::MAX {
            let exact = (f64::from(bits) / 65_536.0 * core::f64::consts::TAU).sin() * 32_768.0;
            worst = worst.max((f64::from(Angle(bits).sin()) - exact).abs());
            let exact = (f64::from(bits) / 65_536.0 * core::f64::consts::TAU).cos() * 32_768.0;
            worst = worst.max((f64::from(Angle(bits).cos()) - exact).abs());
        }
        assert!(worst < 4.0, "{worst}");
    }

    #[test]
    fn sine_is_odd_and_its_ends_are_exact() {
        for bits in 1..0x8000 {
            let (plus, minus) = (Angle(bits).sin(), Angle(bits.wrapping_neg()).sin());
            assert!((plus + minus).abs() <= 1, "{bits}");
        }
        for (bits, sine) in [(0, 0), (0x4000, 32_767), (0x8000, 0), (0xC000, -32_767)] {
            assert_eq!(Angle(bits).sin(), sine);
        }
    }

    #[test]
    fn counts_become_angles_without_drift() {
        for (pairs, counts) in [
            (7, 16_384),
            (7, 40_000),
            (11, 4_001),
            (50, 1_000_000),
            (1, 4),
        ] {
            let scale = ElectricalScale::new(pairs, counts);
            for turns in [0_i64, 1, -1, 1_000_003, -99_999_999] {
                for rest in [0_i64, 1, i64::from(counts) / 3] {
                    let count = turns * i64::from(counts) + rest;
                    let exact =
                        (rest * i64::from(pairs) * 65_536).div_euclid(i64::from(counts)) as u16;
                    let error = scale.angle(count).since(Angle(exact));
                    assert!(
                        (-1..=0).contains(&error),
                        "{pairs} {counts} {turns} {rest}: {error}"
                    );
                }
            }
        }
        assert_eq!(ElectricalScale::new(3, 0).angle(5), Angle(0));
    }

    #[test]
    fn the_short_way_round() {
        assert_eq!(Angle(10).since(Angle(65_530)), 16);
        assert_eq!(Angle(65_530).since(Angle(10)), -16);
    }
}
