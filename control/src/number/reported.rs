//! Conversion between the number formats and `f64`, for reports and for simulated devices.
//!
//! The trait is separate from [`Number`] because a feature of this crate can switch it on. That must not make an implementation of
//! [`Number`] in another crate incomplete.

use super::{Fixed8, Fixed16, Fixed32, Number};

/// A number format whose values convert from and to `f64` in SI units.
pub trait Reported: Number {
    /// Converts a signal (position or force) to `f64`, in SI units.
    fn signal_to_f64(x: Self::Signal) -> f64;
    /// The signal (position or force) nearest to a measured value in SI units, saturating; a NaN gives 0.
    fn signal_from_f64(x: f64) -> Self::Signal;
    /// Converts an energy to `f64`, in J.
    fn energy_to_f64(e: Self::Energy) -> f64;
}

macro_rules! fixed_reported {
    ($name:ident, $int:ty) => {
        // The fixed-point crate's own conversions take some 100 instructions each; these give the same bits in fewer.
        impl Reported for $name {
            #[inline(always)]
            fn signal_to_f64(x: <$name as Number>::Signal) -> f64 {
                f64::from(x.to_bits()) / (1_u64 << <$name as Number>::Signal::FRAC_NBITS) as f64
            }
            #[inline(always)]
            fn signal_from_f64(x: f64) -> <$name as Number>::Signal {
                let (low, high) = (f64::from(<$int>::MIN), f64::from(<$int>::MAX));
                let one = (1_u64 << <$name as Number>::Signal::FRAC_NBITS) as f64;
                // A number beyond the range becomes the limit, because the addition below would lose its digits; a NaN passes and
                // becomes 0.
                let scaled = (x * one).clamp(low, high);
                // Adding 1.5 · 2^52 removes the digits below one, so that the sum is rounded to the nearest, ties to even.
                const WHOLE: f64 = 6_755_399_441_055_744.0;
                <$name as Number>::Signal::from_bits(((scaled + WHOLE) - WHOLE) as $int)
            }
            #[inline(always)]
            fn energy_to_f64(e: <$name as Number>::Energy) -> f64 {
                e.to_bits() as f64 / (1_u64 << <$name as Number>::Energy::FRAC_NBITS) as f64
            }
        }
    };
}

fixed_reported!(Fixed32, i32);
fixed_reported!(Fixed16, i16);
fixed_reported!(Fixed8, i8);

#[cfg(test)]
mod tests {
    use super::*;
    use fixed::types::{I2F14, I8F24, I16F48};

    #[test]
    fn conversions_from_and_to_f64_are_those_of_the_fixed_crate_to_the_bit() {
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            seed ^ (seed >> 29)
        };
        let step = 2f64.powi(-25);
        let edges = [
            0.0,
            -0.0,
            128.0,
            -128.0,
            127.99999997,
            1e300,
            -1e300,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::MIN_POSITIVE,
        ];
        let ties = (-100..100).map(|half| f64::from(half) * step);
        let spread = (0..20_000).map(|index| random() as i64 as f64 * 2f64.powi(-56 - index % 30));
        let spread: Vec<f64> = edges.into_iter().chain(ties).chain(spread).collect();
        for x in spread {
            assert_eq!(
                Fixed32::signal_from_f64(x),
                I8F24::saturating_from_num(x),
                "{x:e}"
            );
            assert_eq!(
                Fixed16::signal_from_f64(x),
                I2F14::saturating_from_num(x),
                "{x:e}"
            );
        }
        assert_eq!(Fixed32::signal_from_f64(f64::NAN), I8F24::ZERO);
        for index in 0..20_000 {
            let bits = (random() as i64) >> (index % 60);
            let (signal, energy) = (I8F24::from_bits(bits as i32), I16F48::from_bits(bits));
            assert_eq!(
                Fixed32::signal_to_f64(signal).to_bits(),
                signal.to_num::<f64>().to_bits()
            );
            assert_eq!(
                Fixed32::energy_to_f64(energy).to_bits(),
                energy.to_num::<f64>().to_bits()
            );
        }
    }
}
