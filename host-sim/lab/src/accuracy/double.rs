//! Numbers with twice the digits of an `f64`: a sum of two `f64` that is stored as two parts, about 31 decimal digits (Dekker,
//! Numerische Mathematik 18, 224, 1971).
//!
//! Only plain IEEE operations are used, so results are the same on every machine.

use std::ops::{Add, Mul, Neg, Sub};

/// The number `high + low`; `low` is at most half a unit in the last place of `high`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Double {
    high: f64,
    low: f64,
}

/// Sum of two numbers and the rounding error of that sum.
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let part = sum - a;
    (sum, (a - (sum - part)) + (b - part))
}

/// Sum of two numbers and the rounding error of that sum, for `|a| >= |b|`.
fn quick_two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// Product of two numbers and the rounding error of that product.
fn two_product(a: f64, b: f64) -> (f64, f64) {
    let split = |x: f64| {
        let shifted = 134_217_729.0 * x;
        let high = shifted - (shifted - x);
        (high, x - high)
    };
    let product = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    let error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    (product, error)
}

impl Double {
    /// The number 0 with twice the digits of an `f64`.
    pub const ZERO: Double = Double {
        high: 0.0,
        low: 0.0,
    };

    /// The `f64` that is nearest to the number.
    #[must_use]
    pub fn to_f64(self) -> f64 {
        self.high
    }

    /// The reciprocal, `1 / self`.
    #[must_use]
    pub fn reciprocal(self) -> Double {
        // Newton's step doubles the digits of the quotient.
        let guess = Double::from(1.0 / self.high);
        guess + guess * (Double::from(1.0) - self * guess)
    }
}

impl From<f64> for Double {
    fn from(high: f64) -> Self {
        Double { high, low: 0.0 }
    }
}

impl Add for Double {
    type Output = Double;
    fn add(self, other: Double) -> Double {
        let (high, error) = two_sum(self.high, other.high);
        let (low, lost) = two_sum(self.low, other.low);
        let (high, low_sum) = quick_two_sum(high, error + low);
        let (high, low) = quick_two_sum(high, low_sum + lost);
        Double { high, low }
    }
}

impl Neg for Double {
    type Output = Double;
    fn neg(self) -> Double {
        Double {
            high: -self.high,
            low: -self.low,
        }
    }
}

impl Sub for Double {
    type Output = Double;
    fn sub(self, other: Double) -> Double {
        self + -other
    }
}

impl Mul for Double {
    type Output = Double;
    fn mul(self, other: Double) -> Double {
        let (product, error) = two_product(self.high, other.high);
        let cross = self.high * other.low + self.low * other.high;
        let (high, low) = quick_two_sum(product, error + cross);
        Double { high, low }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_third_and_a_tenth_have_thirty_digits() {
        let third = Double::from(3.0).reciprocal();
        let rest = third * Double::from(3.0) - Double::from(1.0);
        assert!(rest.to_f64().abs() < 1e-31, "{rest:?}");
        // Ten tenths, each with high and low part.
        let tenth = Double::from(10.0).reciprocal();
        let sum = (0..10).fold(Double::ZERO, |sum, _| sum + tenth);
        assert!((sum - Double::from(1.0)).to_f64().abs() < 1e-31);
        // A small part that a plain sum loses is kept.
        let kept = Double::from(1.0) + Double::from(1e-25) - Double::from(1.0);
        assert_eq!(kept.to_f64(), 1e-25);
    }
}
