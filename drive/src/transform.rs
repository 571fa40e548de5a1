//! Transforms three phases to the rotor's frame and back. They keep amplitudes: a vector is as long as the amplitude of a phase.
//!
//! ```text
//! Clarke   α = a                       β = (a + 2 b)/√3        (c = -a - b)
//! Park     d =  α cos θ + β sin θ      q = -α sin θ + β cos θ
//! back     α = d cos θ - q sin θ       β = d sin θ + q cos θ
//! ```
//!
//! Values are currents or voltages in `I16F16` (16 integer and 16 fractional bits). Sums saturate; values within ±20,000 never
//! reach saturation.

use crate::angle::Angle;
use crate::units::clamp_i32;
use fixed::types::I16F16;

/// The constant `2^31/√3`, rounded.
const ONE_OVER_ROOT_3: i64 = 1_239_850_262;

/// A vector in the stationary frame: α along phase A, β at 90 electrical degrees to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct AlphaBeta {
    /// Component along phase A.
    pub alpha: I16F16,
    /// Component at 90 electrical degrees to phase A.
    pub beta: I16F16,
}

/// A vector in the frame that turns with the rotor.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Dq {
    /// Component along the rotor's field.
    pub d: I16F16,
    /// Component 90 electrical degrees ahead of the rotor's field. This component of the current makes the torque.
    pub q: I16F16,
}

/// Sine and cosine of the rotor's electrical angle, in 1/32,768. They are calculated once per PWM period and used twice.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Rotation {
    sin: i32,
    cos: i32,
}

/// Divides `x` by √3, rounded to the nearest integer.
const fn over_root_3(x: i64) -> i64 {
    (x * ONE_OVER_ROOT_3 + (1 << 30)) >> 31
}

impl AlphaBeta {
    /// Clarke's transform of phases A and B. The third phase is their negative sum, because the star point is not connected.
    #[inline]
    #[must_use]
    pub const fn from_phases(a: I16F16, b: I16F16) -> Self {
        // The sum is at most 3 · 2^31, so the product with 2^31/√3 fits into 64 bits.
        let sum = a.to_bits() as i64 + 2 * b.to_bits() as i64;
        Self {
            alpha: a,
            beta: I16F16::from_bits(clamp_i32(over_root_3(sum))),
        }
    }

    /// The square of the vector's length, with 32 fractional bits.
    #[inline]
    #[must_use]
    pub const fn square(self) -> u64 {
        let (a, b) = (self.alpha.to_bits() as i64, self.beta.to_bits() as i64);
        // Each square is at most 2^62.
        (a * a) as u64 + (b * b) as u64
    }
}

impl Dq {
    /// The zero vector.
    pub const ZERO: Self = Self {
        d: I16F16::ZERO,
        q: I16F16::ZERO,
    };
}

impl Rotation {
    /// Sine and cosine for the rotor's electrical angle.
    #[inline]
    #[must_use]
    pub const fn of(angle: Angle) -> Self {
        Self {
            sin: angle.sin(),
            cos: angle.cos(),
        }
    }

    /// Park's transform, from the stationary frame to the rotor's.
    #[inline]
    #[must_use]
    pub const fn park(self, v: AlphaBeta) -> Dq {
        let (a, b) = (v.alpha.to_bits() as i64, v.beta.to_bits() as i64);
        let (sin, cos) = (self.sin as i64, self.cos as i64);
        Dq {
            d: scaled(a * cos + b * sin),
            q: scaled(b * cos - a * sin),
        }
    }

    /// Park's inverse transform, from the rotor's frame to the stationary one.
    #[inline]
    #[must_use]
    pub const fn back(self, v: Dq) -> AlphaBeta {
        let (d, q) = (v.d.to_bits() as i64, v.q.to_bits() as i64);
        let (sin, cos) = (self.sin as i64, self.cos as i64);
        AlphaBeta {
            alpha: scaled(d * cos - q * sin),
            beta: scaled(d * sin + q * cos),
        }
    }
}

/// Removes the sine's 15 fractional bits from a sum of products, rounding to the nearest.
const fn scaled(sum: i64) -> I16F16 {
    I16F16::from_bits(clamp_i32((sum + (1 << 14)) >> 15))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(x: f64) -> I16F16 {
        I16F16::from_num(x)
    }

    #[test]
    fn three_balanced_phases_are_a_vector_of_their_amplitude() {
        for step in 0..720_u32 {
            let phase = f64::from(step) * core::f64::consts::TAU / 720.0;
            let third = core::f64::consts::TAU / 3.0;
            let (a, b) = (3.0 * phase.cos(), 3.0 * (phase - third).cos());
            let v = AlphaBeta::from_phases(value(a), value(b));
            assert!((v.alpha.to_num::<f64>() - 3.0 * phase.cos()).abs() < 1e-4);
            assert!((v.beta.to_num::<f64>() - 3.0 * phase.sin()).abs() < 1e-4);
            assert!(((v.square() as f64) / 2f64.powi(32) - 9.0).abs() < 1e-3);
            // In a frame that turns with the vector, the vector stands along d.
            let angle = Angle((f64::from(step) * 65_536.0 / 720.0).round() as u16);
            let dq = Rotation::of(angle).park(v);
            assert!((dq.d.to_num::<f64>() - 3.0).abs() < 1e-3, "{dq:?}");
            assert!(dq.q.to_num::<f64>().abs() < 1e-3, "{dq:?}");
        }
    }

    #[test]
    fn there_and_back_is_the_same_vector() {
        for bits in (0..=u16::MAX).step_by(97) {
            let rotation = Rotation::of(Angle(bits));
            let dq = Dq {
                d: value(-7.25),
                q: value(12.5),
            };
            let back = rotation.park(rotation.back(dq));
            assert!((back.d - dq.d).abs() < value(0.003), "{back:?}");
            assert!((back.q - dq.q).abs() < value(0.003), "{back:?}");
        }
    }

    #[test]
    fn the_ends_of_the_range_saturate() {
        let v = AlphaBeta::from_phases(I16F16::MAX, I16F16::MAX);
        assert_eq!(v.beta, I16F16::MAX);
        let v = AlphaBeta::from_phases(I16F16::MIN, I16F16::MIN);
        assert_eq!(v.beta, I16F16::MIN);
        assert!(v.square() >= 1 << 63);
        let dq = Rotation::of(Angle(0x2000)).park(v);
        assert_eq!(dq.d, I16F16::MIN);
        assert_eq!(
            Rotation::of(Angle(0x6000))
                .back(Dq {
                    d: I16F16::MIN,
                    q: I16F16::MAX
                })
                .beta,
            I16F16::MIN
        );
    }
}
