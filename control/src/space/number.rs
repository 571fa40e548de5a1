//! What three axes need of a number format beyond [`Number`]: lengths, directions, shares of a vector.
//!
//! All of it is on magnitudes, so that no bit pattern is an exception: a square of a word has a double word's room three times over. Rounding
//! is always towards zero, that is to the shorter vector; only [`Spatial::length_up`] says what nothing is longer than.

use super::root::{root_16, root_32, root_64};
use crate::magnitude::Word;
use crate::{Fixed8, Fixed16, Fixed32, Number};

/// Three numbers of a format, one an axis.
pub type Axes<T> = [T; 3];

/// Lengths and directions in one number format. All functions are total: they saturate, and divide by no zero.
pub trait Spatial: Number {
    /// 1, or the largest signal where the format ends below it ([`Fixed8`]).
    const ONE: Self::Signal;

    /// `a · b` towards zero, saturating.
    fn times(a: Self::Signal, b: Self::Signal) -> Self::Signal;
    /// `x · part / whole` towards zero with one rounding, saturating; 0 for a `whole` of 0. The sign is that of `x`.
    fn share(x: Self::Signal, part: Self::Signal, whole: Self::Signal) -> Self::Signal;
    /// `u · v` rounded down once, saturating; exact for `u` of whole numbers.
    fn dot(u: Axes<Self::Signal>, v: Axes<Self::Signal>) -> Self::Signal;
    /// `|v|` rounded down: less than a quantum below. Saturates at the largest signal.
    fn length_down(v: Axes<Self::Signal>) -> Self::Signal;
    /// `|v|` rounded up: less than a quantum above. Saturates at the largest signal.
    fn length_up(v: Axes<Self::Signal>) -> Self::Signal;
    /// The direction of `v`; `None` for the zero vector.
    ///
    /// Every component lies at most `1 + g` quanta from `v/|v|`, towards zero, with `g` 2^-6 at 32 bits, 1 at 16 and 2 at 8. So its
    /// length is at most 1, and at 32 bits more than 1 less 1.8 quanta (1.1e-7), however short `v` is.
    fn unit(v: Axes<Self::Signal>) -> Option<Axes<Self::Signal>>;
}

macro_rules! fixed_spatial {
    ($name:ident, word $word:ty, int $int:ty, wide $wide:ty, root $root:ident) => {
        impl $name {
            #[inline(always)]
            fn size(x: <$name as Number>::Signal) -> $word {
                x.to_bits().unsigned_abs()
            }
            #[inline(always)]
            fn with_sign(size: $word, negative: bool) -> <$name as Number>::Signal {
                let bits = size.min(<$word as Word>::MAX_SIGNED) as $int;
                <$name as Number>::Signal::from_bits(if negative {
                    bits.wrapping_neg()
                } else {
                    bits
                })
            }
            /// Three squares of at most `2^(2W-2)` each: fit the unsigned double word.
            #[inline(always)]
            fn squares(v: Axes<$word>) -> $wide {
                let [x, y, z] = v.map(|part| part.times(part));
                x.wrapping_add(y).wrapping_add(z)
            }
            /// Root of a sum of three squares, rounded up.
            #[inline(always)]
            fn root_up(squares: $wide) -> $word {
                let root = $root(squares);
                // Below 2^W sqrt(3)/2, so there is room for the one.
                root.wrapping_add(<$word>::from(root.times(root) != squares))
            }
        }

        impl Spatial for $name {
            const ONE: Self::Signal = {
                let bits = 1_i64 << <$name as Number>::Signal::FRAC_NBITS;
                let most = <$int>::MAX as i64;
                <$name as Number>::Signal::from_bits(if bits > most {
                    <$int>::MAX
                } else {
                    bits as $int
                })
            };

            #[inline(always)]
            fn times(a: Self::Signal, b: Self::Signal) -> Self::Signal {
                let product = Self::size(a).times(Self::size(b));
                let size = <$word as Word>::shift_down(product, Self::Signal::FRAC_NBITS);
                Self::with_sign(<$word as Word>::narrow(size), (a < 0) != (b < 0))
            }
            #[inline(always)]
            fn share(x: Self::Signal, part: Self::Signal, whole: Self::Signal) -> Self::Signal {
                let product = Self::size(x).times(Self::size(part));
                let size = Self::size(whole)
                    .divides_within(product)
                    .map_or(<$word as Word>::MAX_SIGNED, |(size, _)| size);
                Self::with_sign(size, x < 0)
            }
            #[inline(always)]
            fn dot(u: Axes<Self::Signal>, v: Axes<Self::Signal>) -> Self::Signal {
                let product = |a: Self::Signal, b: Self::Signal| {
                    i64::from(a.to_bits()).wrapping_mul(i64::from(b.to_bits()))
                };
                let ([ux, uy, uz], [vx, vy, vz]) = (u, v);
                // Of words of 32 bits, three largest products do not fit; of a direction and a vector, they do.
                let sum = product(ux, vx)
                    .saturating_add(product(uy, vy))
                    .saturating_add(product(uz, vz));
                let down = sum >> Self::Signal::FRAC_NBITS;
                let (least, most) = (i64::from(<$int>::MIN), i64::from(<$int>::MAX));
                Self::Signal::from_bits(down.max(least).min(most) as $int)
            }
            #[inline(always)]
            fn length_down(v: Axes<Self::Signal>) -> Self::Signal {
                Self::with_sign($root(Self::squares(v.map(Self::size))), false)
            }
            #[inline(always)]
            fn length_up(v: Axes<Self::Signal>) -> Self::Signal {
                Self::with_sign(Self::root_up(Self::squares(v.map(Self::size))), false)
            }
            #[inline]
            fn unit(v: Axes<Self::Signal>) -> Option<Axes<Self::Signal>> {
                let sizes = v.map(Self::size);
                let [x, y, z] = sizes;
                let all = x | y | z;
                if all == 0 {
                    return None;
                }
                // So long that the root has all its digits, and so short that the squares fit: the highest bit but one.
                let scale = (1 as $word).wrapping_shl(all.leading_zeros().saturating_sub(1));
                let scaled = sizes.map(|size| size.wrapping_mul(scale));
                // The one value whose highest bit is set is a power of two: its square fits three times as well.
                let length = Self::root_up(Self::squares(scaled));
                let mut unit = [Self::Signal::ZERO; 3];
                for (out, (size, x)) in unit.iter_mut().zip(scaled.into_iter().zip(v)) {
                    let lifted = <$wide>::from(size) << Self::Signal::FRAC_NBITS;
                    let size = length
                        .divides_within(lifted)
                        .map_or(<$word as Word>::MAX_SIGNED, |(size, _)| size);
                    *out = Self::with_sign(size, x < 0);
                }
                Some(unit)
            }
        }
    };
}
fixed_spatial!(Fixed32, word u32, int i32, wide u64, root root_64);
fixed_spatial!(Fixed16, word u16, int i16, wide u32, root root_32);
fixed_spatial!(Fixed8, word u8, int i8, wide u16, root root_16);

#[cfg(feature = "float")]
macro_rules! float_spatial {
    ($float:ty) => {
        impl Spatial for $float {
            const ONE: $float = 1.0;

            #[inline(always)]
            fn times(a: $float, b: $float) -> $float {
                a * b
            }
            #[inline(always)]
            fn share(x: $float, part: $float, whole: $float) -> $float {
                if whole == 0.0 {
                    0.0
                } else {
                    x * (part / whole)
                }
            }
            #[inline(always)]
            fn dot(u: Axes<$float>, v: Axes<$float>) -> $float {
                u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
            }
            #[inline(always)]
            fn length_down(v: Axes<$float>) -> $float {
                Self::dot(v, v).sqrt()
            }
            #[inline(always)]
            fn length_up(v: Axes<$float>) -> $float {
                Self::dot(v, v).sqrt()
            }
            #[inline]
            fn unit(v: Axes<$float>) -> Option<Axes<$float>> {
                let length = Self::length_down(v);
                (length > 0.0).then(|| v.map(|x| x / length))
            }
        }
    };
}
#[cfg(feature = "float")]
float_spatial!(f32);
#[cfg(feature = "float")]
float_spatial!(f64);
