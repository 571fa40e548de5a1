//! Displacements with far more digits than a [`Signal`](super::Number::Signal): the states of an estimator.
//!
//! A velocity is kept as a displacement per tick, and an acceleration as a displacement per tick². At 1 kHz one encoder count
//! (1.6e-4 rad) per second is 1.6e-7 rad per tick. So a state is a 64-bit word with 54 fractional bits, ±512 rad in steps of
//! 5.6e-17. In a multiplication only the leading 32 bits of a state are used: [`Wide::Part`], ±8 rad in steps of 3.7e-9 for motion,
//! ±128 N·m in steps of 6e-8 for a torque. The fractional bits of a state's part and of its weight add up to 54, so every product
//! is exact and needs no shift. The weight of a motion is ±32 in steps of 1.5e-8, that of a torque ±2 in steps of 9.3e-10.

use core::fmt::Debug;

/// Type in which an estimator's coefficient is calculated before it is rounded: ±128 in steps of 1.4e-17.
pub type Exact = fixed::types::I8F56;

/// A displacement in rad (m), or a displacement per tick or per tick², with many digits.
pub trait Wide: Copy + Debug + Default + PartialEq + 'static {
    /// The leading digits of a state or of a torque. Only these are multiplied with weights, so that products are fast.
    type Part: Copy + Debug + Default + PartialEq;
    /// A coefficient that is multiplied with the leading digits of a state or torque.
    type Weight: Copy + Debug + Default + PartialOrd;

    /// Converts a coefficient of a motion to a weight, to nearest; `None` outside ±32.
    fn weight(value: Exact) -> Option<Self::Weight>;
    /// Converts a coefficient of a torque, rad/(N·m) per tick², to a weight, to nearest; `None` outside ±2.
    fn torque_weight(value: Exact) -> Option<Self::Weight>;

    /// `self + other` without an overflow check; the caller guarantees that the sum fits.
    fn plus_fitting(self, other: Self) -> Self;
    /// `self - other` without an overflow check; the caller guarantees that the difference fits.
    fn minus_fitting(self, other: Self) -> Self;
    /// Weight times the leading digits of a state or torque, exact.
    fn product(weight: Self::Weight, part: Self::Part) -> Self;
    /// The leading digits of a value, rounded down; the caller guarantees that the value is within ±8.
    fn part(self) -> Self::Part;
    /// The leading digits of a torque that was converted from a signal: exact in the fixed formats.
    fn torque_part(self) -> Self::Part;
    /// Whether the value is within ±`1 << bits`, the lower end included; `bits` up to 8.
    fn within(self, bits: u32) -> bool;
}

/// The estimator's state in the fixed-point formats: a 64-bit integer with 54 fractional bits.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Wide64(pub i64);

impl Wide64 {
    /// Number of fractional bits of an estimator's state.
    pub const FRACTION: u32 = 54;
    const PART: u32 = 28;
    const TORQUE: u32 = 24;

    fn rounded(value: Exact, fraction: u32) -> Option<i32> {
        let down = Exact::FRAC_NBITS.wrapping_sub(fraction);
        let half = 1_i64.wrapping_shl(down.wrapping_sub(1));
        i32::try_from(value.to_bits().saturating_add(half) >> down).ok()
    }

    /// The leading 32 bits with `fraction` fractional bits, rounded down.
    #[inline(always)]
    fn leading(self, fraction: u32) -> i32 {
        let down = Self::FRACTION.wrapping_sub(fraction);
        debug_assert!(
            i32::try_from(self.0 >> down).is_ok(),
            "{} is no part",
            self.0
        );
        if cfg!(target_pointer_width = "64") {
            (self.0 >> down) as i32
        } else {
            word_of(self.0, down)
        }
    }
}

/// The 32-bit word that begins at bit `from` (1 to 31) of a 64-bit number, put together from the number's two halves. In this form
/// a compiler for a 32-bit machine uses one 32-bit multiplication for a product with the word.
#[inline(always)]
#[must_use]
pub const fn word_of(bits: i64, from: u32) -> i32 {
    let (high, low) = ((bits >> 32) as u32, bits as u32);
    let up = 32_u32.wrapping_sub(from);
    (high.wrapping_shl(up) | low.wrapping_shr(from)).cast_signed()
}

impl Wide for Wide64 {
    type Part = i32;
    type Weight = i32;

    fn weight(value: Exact) -> Option<i32> {
        Self::rounded(value, Self::FRACTION.wrapping_sub(Self::PART))
    }
    fn torque_weight(value: Exact) -> Option<i32> {
        Self::rounded(value, Self::FRACTION.wrapping_sub(Self::TORQUE))
    }
    #[inline(always)]
    fn plus_fitting(self, other: Self) -> Self {
        debug_assert!(self.0.checked_add(other.0).is_some(), "{self:?} {other:?}");
        Self(self.0.wrapping_add(other.0))
    }
    #[inline(always)]
    fn minus_fitting(self, other: Self) -> Self {
        debug_assert!(self.0.checked_sub(other.0).is_some(), "{self:?} {other:?}");
        Self(self.0.wrapping_sub(other.0))
    }
    #[inline(always)]
    fn product(weight: i32, part: i32) -> Self {
        // A product of two 32-bit words fits 64 bits.
        Self(i64::from(weight).wrapping_mul(i64::from(part)))
    }
    #[inline(always)]
    fn part(self) -> i32 {
        self.leading(Self::PART)
    }
    #[inline(always)]
    fn torque_part(self) -> i32 {
        self.leading(Self::TORQUE)
    }
    #[inline(always)]
    fn within(self, bits: u32) -> bool {
        let high = (self.0 >> 32) as i32;
        let limit = 1_i32.wrapping_shl(Self::FRACTION.wrapping_sub(32).wrapping_add(bits));
        high >= limit.wrapping_neg() && high < limit
    }
}

#[cfg(feature = "float")]
macro_rules! float_wide {
    ($float:ty) => {
        impl Wide for $float {
            type Part = $float;
            type Weight = $float;

            fn weight(value: Exact) -> Option<$float> {
                Some(value.to_num())
            }
            fn torque_weight(value: Exact) -> Option<$float> {
                Some(value.to_num())
            }
            #[inline(always)]
            fn plus_fitting(self, other: Self) -> Self {
                self + other
            }
            #[inline(always)]
            fn minus_fitting(self, other: Self) -> Self {
                self - other
            }
            #[inline(always)]
            fn product(weight: $float, part: $float) -> Self {
                weight * part
            }
            #[inline(always)]
            fn part(self) -> $float {
                self
            }
            #[inline(always)]
            fn torque_part(self) -> $float {
                self
            }
            #[inline(always)]
            fn within(self, bits: u32) -> bool {
                let limit = <$float>::from(1_u16.wrapping_shl(bits));
                self >= -limit && self < limit
            }
        }
    };
}
#[cfg(feature = "float")]
float_wide!(f32);
#[cfg(feature = "float")]
float_wide!(f64);
