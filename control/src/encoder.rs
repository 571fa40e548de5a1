//! From encoder count to penetration: the first step of the tick, in integers on every machine.

use crate::number::Saturates as _;
use crate::{Number, Position, Si};

/// Fractional bits of the angle of one count. 48 keep a turn of 40,000 counts exact to 1.4e-10 rad.
const STEP_BITS: u32 = 48;
/// `round(2 π · 2^48)`.
const TURN: i64 = 1_768_559_438_007_110;

/// Angle of an encoder's counts relative to a wall's surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CountScale {
    /// Angle of one count, rad, with [`STEP_BITS`] fractional bits.
    step: i64,
    surface: Si,
}

impl CountScale {
    /// For an encoder with so many counts a revolution (all edges counted) and a surface at an angle in rad.
    /// `None` for an encoder without counts.
    #[must_use]
    pub fn new(counts_per_rev: u32, surface: Si) -> Option<Self> {
        let counts = i64::from(counts_per_rev);
        let step = TURN.checked_add(counts / 2)?.checked_div(counts)?;
        Some(Self { step, surface })
    }

    /// The same encoder before another surface.
    #[inline(always)]
    #[must_use]
    pub fn before(self, surface: Si) -> Self {
        Self { surface, ..self }
    }

    /// Angle of a count, to the step of [`Si`] towards zero, whatever the surface: that of `-count` is its negative, exactly.
    #[inline]
    #[must_use]
    pub fn angle(&self, count: i64) -> Si {
        // A step is positive. In 128 bits, so that a knob may turn on for as long as its counts go.
        let size =
            u128::from(count.unsigned_abs()).wrapping_mul(u128::from(self.step.unsigned_abs()));
        let size = i64::try_from(size >> (STEP_BITS - Si::FRAC_NBITS)).unwrap_or(i64::MAX);
        Si::from_bits(if count < 0 { size.wrapping_neg() } else { size })
    }

    /// Penetration for a count, to the step below in the format, saturating: `e = 2π count / counts_per_rev - x_s`.
    ///
    /// Counts reach ±32,767 rad before they saturate.
    #[inline]
    #[must_use]
    pub fn penetration<N: Number>(&self, count: i64) -> Position<N> {
        let angle = Si::from_bits(count.saturating_mul(self.step) >> (STEP_BITS - Si::FRAC_NBITS));
        let penetration = Si::from_bits(angle.to_bits().difference(self.surface.to_bits()));
        Position(N::saturating_signal(penetration))
    }
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
}
