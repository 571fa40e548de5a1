//! Floating-point formats as a reference for the fixed-point ones: the same laws, rounded to nearest. Measured values saturate,
//! calculated ones do not.

use super::{Number, Reported};
use crate::Si;

/// Measured values in the floating-point formats saturate at ± this value, the range of [`super::Fixed32`].
const LARGEST: f64 = 128.0;

macro_rules! float_number {
    ($float:ty, $text:literal) => {
        impl Number for $float {
            type Signal = $float;
            type Gain = $float;
            type Ratio = $float;
            type Energy = $float;
            type Product = $float;
            type Divisor = $float;
            type Wide = $float;

            const NAME: &'static str = $text;
            // The step of Fixed32, so that the smallest step of the offset is the same as there.
            const QUANTUM: $float = 1.0 / 16_777_216.0;

            fn signal(si: Si) -> Option<$float> {
                Some(si.to_num())
            }
            fn saturating_signal(si: Si) -> $float {
                let x: $float = si.to_num();
                x.clamp(-LARGEST as $float, LARGEST as $float)
            }
            fn gain(si: Si) -> Option<$float> {
                if si.is_negative() {
                    None
                } else {
                    Some(si.to_num())
                }
            }
            fn ratio(si: Si) -> Option<$float> {
                Self::gain(si)
            }
            fn energy(si: Si) -> Option<$float> {
                Some(si.to_num())
            }
            #[inline(always)]
            fn add(a: $float, b: $float) -> $float {
                a + b
            }
            #[inline(always)]
            fn sub(a: $float, b: $float) -> $float {
                a - b
            }
            #[inline(always)]
            fn neg(a: $float) -> $float {
                -a
            }
            #[inline(always)]
            fn modulus(a: $float) -> $float {
                if a < 0.0 { -a } else { a }
            }
            #[inline(always)]
            fn scale(r: $float, x: $float) -> $float {
                r * x
            }
            #[inline(always)]
            fn product(k: $float, x: $float) -> $float {
                k * x
            }
            #[inline(always)]
            fn lift(x: $float) -> $float {
                x
            }
            #[inline(always)]
            fn add_product(a: $float, b: $float) -> $float {
                a + b
            }
            #[inline(always)]
            fn sub_product(a: $float, b: $float) -> $float {
                a - b
            }
            #[inline(always)]
            fn add_fitting(a: $float, b: $float) -> $float {
                a + b
            }
            #[inline(always)]
            fn sub_fitting(a: $float, b: $float) -> $float {
                a - b
            }
            #[inline(always)]
            fn positive_down(p: $float) -> $float {
                if p > 0.0 { p } else { 0.0 }
            }
            #[inline(always)]
            fn positive_up(p: $float) -> $float {
                Self::positive_down(p)
            }
            #[inline(always)]
            fn round_to_zero(p: $float) -> $float {
                p
            }
            #[inline(always)]
            fn round_up(p: $float) -> $float {
                p
            }
            #[inline(always)]
            fn divide(p: $float, k: $float) -> $float {
                if k == 0.0 { 0.0 } else { p / k }
            }
            fn divisor(k: $float) -> $float {
                k
            }
            #[inline(always)]
            fn divide_by(p: $float, k: &$float) -> $float {
                Self::divide(p, *k)
            }

            #[inline(always)]
            fn widen(x: $float) -> $float {
                x
            }
            #[inline(always)]
            fn narrow(x: $float) -> $float {
                x
            }

            #[inline(always)]
            fn work(f: $float, d: $float) -> $float {
                f * d
            }
            #[inline(always)]
            fn add_energy(a: $float, b: $float) -> $float {
                a + b
            }
            #[inline(always)]
            fn sub_energy(a: $float, b: $float) -> $float {
                a - b
            }
            #[inline(always)]
            fn add_energy_fitting(a: $float, b: $float) -> $float {
                a + b
            }
            #[inline(always)]
            fn sub_energy_fitting(a: $float, b: $float) -> $float {
                a - b
            }
            #[inline(always)]
            fn energy_digits_fitting(e: $float) -> $float {
                e
            }
            #[inline(always)]
            fn modulus_fitting(a: $float) -> $float {
                Self::modulus(a)
            }
            #[inline(always)]
            fn scale_both_fitting(r: $float, x: $float, q: $float, y: $float) -> $float {
                r * x + q * y
            }
            #[inline(always)]
            fn round_down_fitting(p: $float) -> $float {
                p
            }
            #[inline(always)]
            fn half_energy_up(e: $float) -> $float {
                e / 2.0
            }
            #[inline(always)]
            fn energy_per(e: $float, x: $float) -> $float {
                let e = if e < 0.0 { -e } else { e };
                let x = if x < 0.0 { -x } else { x };
                if x == 0.0 { <$float>::MAX } else { e / x }
            }
            #[inline(always)]
            fn root(e: $float) -> $float {
                if e > 0.0 { root::<$float>(e) } else { 0.0 }
            }
            fn root_of_four(k: $float) -> $float {
                if k > 0.0 {
                    root::<$float>(4.0 * k)
                } else {
                    0.0
                }
            }
            #[inline(always)]
            fn affordable(e: $float, f: $float) -> ($float, $float) {
                // Without rounding no energy is left over.
                if f > 0.0 && e > 0.0 {
                    (e / f, 0.0)
                } else {
                    (0.0, if e > 0.0 { e } else { 0.0 })
                }
            }
            #[inline(always)]
            fn passivity_step(e: $float, f: $float, d: $float) -> ($float, $float) {
                let e = if e < 0.0 { 0.0 } else { e };
                let f = if f < 0.0 { 0.0 } else { f };
                let after = e + f * d;
                // After a correction the energy left is the remainder of the division, which is 0 without rounding.
                if after >= 0.0 {
                    (after, f)
                } else {
                    (0.0, e / -d)
                }
            }
        }

        impl Reported for $float {
            fn signal_to_f64(x: $float) -> f64 {
                f64::from(x)
            }
            fn signal_from_f64(x: f64) -> $float {
                // An infinity, or a number with infinite products, would make the next difference a NaN.
                if x.is_nan() {
                    0.0
                } else {
                    x.clamp(-LARGEST, LARGEST) as $float
                }
            }
            fn energy_to_f64(e: $float) -> f64 {
                f64::from(e)
            }
        }
    };
}

/// Square root of floating-point numbers, which `core` does not have. IEEE 754 defines every bit of the result, so the result
/// equals that of the processor and of the standard library.
pub(crate) trait Root {
    fn sqrt(self) -> Self;
}
impl Root for f32 {
    fn sqrt(self) -> f32 {
        libm::sqrtf(self)
    }
}
impl Root for f64 {
    fn sqrt(self) -> f64 {
        libm::sqrt(self)
    }
}
fn root<F: Root>(x: F) -> F {
    Root::sqrt(x)
}

float_number!(f32, "f32");
float_number!(f64, "f64");
