//! Operations that three axes need of a number format beyond [`Number`]: lengths, directions, fractions of a vector.
//!
//! Lengths are calculated from magnitudes, so that no bit pattern is an exception: a double word holds the sum of three squares.
//! Vectors are rounded towards zero, so they are never too long. Scalar products are rounded down, and only [`Spatial::length_up`]
//! rounds a length up.

use super::root::{root_16, root_32, root_64, root_high_16, root_high_32, root_high_64};
use crate::magnitude::Word;
use crate::{Fixed8, Fixed16, Fixed32, Number};

/// Three numbers of one number format: x, y and z.
pub type Axes<T> = [T; 3];

/// Lengths and directions in one number format. Every function has a result for every input: it saturates and never divides by
/// zero.
pub trait Spatial: Number {
    /// The value 1, or the largest signal of a format whose range ends below 1 ([`Fixed8`]).
    const ONE: Self::Signal;

    /// Product of two signals, rounded towards zero, saturating.
    fn times(a: Self::Signal, b: Self::Signal) -> Self::Signal;
    /// The part of a length for each axis of the direction `u`, without the direction's signs: `|u_i| · length`, rounded towards
    /// zero, saturating. Each part has the sign of the length.
    fn share_of_length(u: Axes<Self::Signal>, length: Self::Signal) -> Axes<Self::Signal>;
    /// `x · part / whole`, rounded once and towards zero, saturating; 0 for a `whole` of 0. The sign is that of `x`.
    fn share(x: Self::Signal, part: Self::Signal, whole: Self::Signal) -> Self::Signal;
    /// Scalar product of a direction `u` and a vector `v`, rounded down once, saturating; exact if the components of `u` are whole
    /// numbers.
    fn along(u: Axes<Self::Signal>, v: Axes<Self::Signal>) -> Self::Signal;
    /// Length `|v|` rounded down, less than one step of the format too short. Saturates at the largest signal.
    fn length_down(v: Axes<Self::Signal>) -> Self::Signal;
    /// Length `|v|` rounded up, less than one step of the format too long. Saturates at the largest signal.
    fn length_up(v: Axes<Self::Signal>) -> Self::Signal;
    /// Whether the vector is longer than a limit of at least 0; exact, and without a root.
    fn longer(v: Axes<Self::Signal>, limit: Self::Signal) -> bool;
    /// Three quarters of `x`, rounded down, for `x >= 0`.
    fn three_quarters(x: Self::Signal) -> Self::Signal;
    /// `v · part/whole` for `0 <= part < whole`, with each component rounded towards zero. One quotient serves all three
    /// components, so each is at most two steps of the number format too short.
    fn shortened(
        v: Axes<Self::Signal>,
        part: Self::Signal,
        whole: Self::Signal,
    ) -> Axes<Self::Signal>;
    /// Square root of an energy: the largest signal whose square does not exceed `e`; 0 for a negative `e`. Same as
    /// [`Number::root`], but faster.
    fn root_of_squares(e: Self::Energy) -> Self::Signal;
    /// The part of `v` perpendicular to the direction `u`. Each component is right within two steps of the number format, rounded
    /// towards zero; the result is never longer than `v`.
    fn across(u: Axes<Self::Signal>, v: Axes<Self::Signal>) -> Axes<Self::Signal>;
    /// A direction turned towards another one by an angle that is given by cosine and sine. Each component is right within three
    /// steps of the number format; the result is never longer than 1. `None` if the two directions are parallel or opposite.
    fn turned(
        u: Axes<Self::Signal>,
        towards: Axes<Self::Signal>,
        turn: [Self::Signal; 2],
    ) -> Option<Axes<Self::Signal>>;
    /// The length of a vector, rounded down, and its direction, with a single square root. Same as [`Spatial::length_down`] and
    /// [`Spatial::unit`].
    fn polar(v: Axes<Self::Signal>) -> (Self::Signal, Option<Axes<Self::Signal>>);
    /// The direction of `v`; `None` for the zero vector.
    ///
    /// Every component is rounded towards zero and lies at most `1 + g` steps of the number format from that of `v/|v|`; `g` is
    /// 2^-6 at 32 bits, 1 at 16 and 2 at 8. So the direction's length is at most 1. At 32 bits it is at least 1 less 1.8 steps
    /// (1.1e-7), however short `v` is.
    fn unit(v: Axes<Self::Signal>) -> Option<Axes<Self::Signal>>;
}

/// `x / 2^bits`, rounded towards zero.
#[inline(always)]
fn towards_zero(x: i64, bits: u32) -> i64 {
    let ones = 1_i64.wrapping_shl(bits).wrapping_sub(1);
    x.wrapping_add((x >> 63) & ones) >> bits
}

/// The vector product (cross product); the caller guarantees that the products of components fit.
#[inline(always)]
fn cross([ax, ay, az]: Axes<i64>, [bx, by, bz]: Axes<i64>) -> Axes<i64> {
    let minor = |a: i64, b: i64, c: i64, d: i64| a.wrapping_mul(b).wrapping_sub(c.wrapping_mul(d));
    [
        minor(ay, bz, az, by),
        minor(az, bx, ax, bz),
        minor(ax, by, ay, bx),
    ]
}

/// Fractional bits of the components of a vector whose length is nearly 1.
const NEAR_ONE: u32 = 30;

/// Makes a vector 1 long by `v (3 - |v|²)/2`, Newton's step for a reciprocal root. The vector is at most `sqrt(2)` long and has
/// [`NEAR_ONE`] fractional bits; the result has `digits` fractional bits, rounded towards zero. The new error of the length is 1.5
/// times the square of the old one. The result is never longer than 1, since `x (3 - x²)/2 <= 1`.
#[inline(always)]
fn lengthened(v: Axes<i64>, digits: u32) -> Axes<i64> {
    const DOWN: u32 = 2 * NEAR_ONE + 1;
    // Each component fits a 32-bit word. The casts tell the compiler so, which saves two products.
    let [x, y, z] = v.map(|x| i64::from(x as i32));
    let squares = x
        .wrapping_mul(x)
        .wrapping_add(y.wrapping_mul(y))
        .wrapping_add(z.wrapping_mul(z));
    // The factor is rounded down.
    let factor = (3_i64 << (2 * NEAR_ONE)).wrapping_sub(squares) >> NEAR_ONE;
    [x, y, z].map(|x| towards_zero(x.wrapping_mul(factor), DOWN.wrapping_sub(digits)))
}

macro_rules! fixed_spatial {
    ($name:ident, word $word:ty, int $int:ty, wide $wide:ty, root $root:ident, $root_high:ident) => {
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
            /// The sum of three squares. Each square is at most `2^(2W-2)` for a word of `W` bits, so the sum fits the unsigned
            /// double word.
            #[inline(always)]
            fn squares(v: Axes<$word>) -> $wide {
                let [x, y, z] = v.map(|part| part.times(part));
                x.wrapping_add(y).wrapping_add(z)
            }
            /// Largest error of a direction's component that is calculated as a product with an inverse instead of a quotient. In
            /// steps of the number format: one, plus 2^(fractional bits + 3 - bits of a word).
            const SMALLER: u32 =
                1 + match (<$name as Number>::Signal::FRAC_NBITS + 3).checked_sub(<$word>::BITS) {
                    Some(bits) => 1 << bits,
                    None => 0,
                };
            /// The vector converted to double words.
            #[inline(always)]
            fn long(v: Axes<<$name as Number>::Signal>) -> Axes<i64> {
                v.map(|x| i64::from(x.to_bits()))
            }
            /// The scalar product of a direction, which is at most 1 long, and a vector. No sum overflows.
            #[inline(always)]
            fn inner([ux, uy, uz]: Axes<i64>, [vx, vy, vz]: Axes<i64>) -> i64 {
                ux.wrapping_mul(vx)
                    .wrapping_add(uy.wrapping_mul(vy))
                    .wrapping_add(uz.wrapping_mul(vz))
            }
            /// A product of two signals, rounded down to a signal, saturating.
            #[inline(always)]
            fn rounded_down(product: i64) -> <$name as Number>::Signal {
                let down = product >> <$name as Number>::Signal::FRAC_NBITS;
                let (least, most) = (i64::from(<$int>::MIN), i64::from(<$int>::MAX));
                <$name as Number>::Signal::from_bits(down.max(least).min(most) as $int)
            }
            /// The leading digits of a vector of double words, shifted so that the largest component uses all bits of a word except
            /// the two highest. `None` for the zero vector.
            #[inline(always)]
            fn leading(v: Axes<i64>) -> Option<Axes<<$name as Number>::Signal>> {
                let [x, y, z] = v.map(i64::unsigned_abs);
                let bits = u64::BITS.wrapping_sub((x | y | z).leading_zeros());
                let room = <$word>::BITS - 2;
                if bits == 0 {
                    return None;
                }
                let digits = match bits.checked_sub(room) {
                    Some(down) => v.map(|x| x >> down),
                    None => v.map(|x| x << room.wrapping_sub(bits)),
                };
                Some(digits.map(|x| <$name as Number>::Signal::from_bits(x as $int)))
            }
            /// Square root of a sum of three squares, rounded up.
            #[inline(always)]
            fn root_up(squares: $wide) -> $word {
                let root = $root(squares);
                // The root is below 2^W sqrt(3)/2 for words of W bits, so adding 1 cannot overflow.
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
            fn share_of_length(u: Axes<Self::Signal>, length: Self::Signal) -> Axes<Self::Signal> {
                let size = Self::size(length);
                u.map(|part| {
                    let product = Self::size(part).times(size);
                    let size = <$word as Word>::shift_down(product, Self::Signal::FRAC_NBITS);
                    Self::with_sign(<$word as Word>::narrow(size), length < 0)
                })
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
            fn along(u: Axes<Self::Signal>, v: Axes<Self::Signal>) -> Self::Signal {
                Self::rounded_down(Self::inner(Self::long(u), Self::long(v)))
            }
            #[inline(always)]
            fn length_down(v: Axes<Self::Signal>) -> Self::Signal {
                Self::with_sign($root(Self::squares(v.map(Self::size))), false)
            }
            #[inline(always)]
            fn length_up(v: Axes<Self::Signal>) -> Self::Signal {
                Self::with_sign(Self::root_up(Self::squares(v.map(Self::size))), false)
            }
            #[inline(always)]
            fn longer(v: Axes<Self::Signal>, limit: Self::Signal) -> bool {
                let limit = Self::size(limit);
                Self::squares(v.map(Self::size)) > limit.times(limit)
            }
            #[inline(always)]
            fn three_quarters(x: Self::Signal) -> Self::Signal {
                let size = Self::size(x);
                // The size is below half of the word's range, so adding 3 cannot overflow.
                Self::with_sign(size.wrapping_sub(size.wrapping_add(3) >> 2), x < 0)
            }
            #[inline(always)]
            fn shortened(
                v: Axes<Self::Signal>,
                part: Self::Signal,
                whole: Self::Signal,
            ) -> Axes<Self::Signal> {
                const DOWN: u32 = <$word>::BITS - 1;
                // A fraction below 1, with as many digits as a component has.
                let share = Self::size(whole)
                    .divides_within(<$wide>::from(Self::size(part)) << DOWN)
                    .map_or(<$word as Word>::MAX_SIGNED, |(share, _)| share);
                v.map(|x| Self::with_sign((Self::size(x).times(share) >> DOWN) as $word, x < 0))
            }
            #[inline(always)]
            fn root_of_squares(e: Self::Energy) -> Self::Signal {
                Self::with_sign($root(e.to_bits().max(0).unsigned_abs()), false)
            }
            #[inline(always)]
            fn across(u: Axes<Self::Signal>, v: Axes<Self::Signal>) -> Axes<Self::Signal> {
                const ONE_BITS: u32 = <$name as Number>::Signal::FRAC_NBITS;
                let ([ux, uy, uz], [vx, vy, vz]) = (Self::long(u), Self::long(v));
                let along = towards_zero(Self::inner([ux, uy, uz], [vx, vy, vz]), ONE_BITS);
                let part = |u: i64, v: i64| {
                    let long = (v << ONE_BITS).wrapping_sub(along.wrapping_mul(u));
                    Self::Signal::from_bits(towards_zero(long, ONE_BITS) as $int)
                };
                [part(ux, vx), part(uy, vy), part(uz, vz)]
            }
            #[inline]
            fn turned(
                u: Axes<Self::Signal>,
                towards: Axes<Self::Signal>,
                [cosine, sine]: [Self::Signal; 2],
            ) -> Option<Axes<Self::Signal>> {
                const DIGITS: u32 = <$name as Number>::Signal::FRAC_NBITS;
                // u × (towards × u) is the part of `towards` perpendicular to `u`, exact except that the inner product is
                // shortened once. So no digits are lost if the two directions are nearly parallel.
                let axis = cross(Self::long(towards), Self::long(u));
                let axis = Self::long(Self::leading(axis)?);
                let side = Self::unit(Self::leading(cross(Self::long(u), axis))?)?;
                let (cosine, sine) = (i64::from(cosine.to_bits()), i64::from(sine.to_bits()));
                let part = |u: i64, side: i64| {
                    let long = cosine.wrapping_mul(u).wrapping_add(sine.wrapping_mul(side));
                    // The product has twice DIGITS fractional bits, of which NEAR_ONE are enough.
                    match (2 * DIGITS).checked_sub(NEAR_ONE) {
                        Some(down) => long >> down,
                        None => long << NEAR_ONE.saturating_sub(2 * DIGITS),
                    }
                };
                let ([ux, uy, uz], [sx, sy, sz]) = (Self::long(u), Self::long(side));
                let unit = lengthened([part(ux, sx), part(uy, sy), part(uz, sz)], DIGITS);
                // A format whose range ends below 1 gets its largest number instead of 1.
                Some(unit.map(|x| Self::with_sign(x.unsigned_abs() as $word, x < 0)))
            }
            #[inline]
            fn polar(v: Axes<Self::Signal>) -> (Self::Signal, Option<Axes<Self::Signal>>) {
                const ONE_BITS: u32 = <$name as Number>::Signal::FRAC_NBITS;
                const INVERSE_BITS: u32 = 2 * <$word>::BITS - 3;
                let sizes = v.map(Self::size);
                let [x, y, z] = sizes;
                let all = x | y | z;
                if all == 0 {
                    return (Self::Signal::ZERO, None);
                }
                // Scales the vector so that the second-highest bit of its largest component is set: the root then has all its
                // digits, and the squares fit.
                let up = all.leading_zeros().saturating_sub(1);
                let scale = (1 as $word).wrapping_shl(up);
                let scaled = sizes.map(|size| size.wrapping_mul(scale));
                // A scaled component with the highest bit set is 2^(W-1), the absolute value of the lowest number; three times
                // its square still fits.
                let squares = Self::squares(scaled);
                let root = $root_high(squares);
                // The root is below 2^W sqrt(3)/2 for words of W bits, so adding 1 cannot overflow.
                let length = root.wrapping_add(<$word>::from(root.times(root) != squares));
                // One inverse of the length replaces three quotients. The length is at least 2^(W-2), so the inverse fits a signed
                // word; stating this bound again saves a check in the compiled code.
                let ones = ((1 as $wide) << INVERSE_BITS).wrapping_sub(1);
                let inverse = length
                    .max(1 << (<$word>::BITS - 2))
                    .divides_within(ones)
                    .map_or(<$word as Word>::MAX_SIGNED, |(inverse, _)| inverse);
                let mut unit = [Self::Signal::ZERO; 3];
                for (out, (size, x)) in unit.iter_mut().zip(scaled.into_iter().zip(v)) {
                    // The product may be a few steps too small; the remainder corrects it.
                    let mut size_of_part =
                        (size.times(inverse) >> (INVERSE_BITS - ONE_BITS)) as $word;
                    let mut rest =
                        (<$wide>::from(size) << ONE_BITS).wrapping_sub(size_of_part.times(length));
                    for _ in 0..Self::SMALLER {
                        if rest >= <$wide>::from(length) {
                            rest = rest.wrapping_sub(<$wide>::from(length));
                            size_of_part = size_of_part.wrapping_add(1);
                        }
                    }
                    *out = Self::with_sign(size_of_part, x < 0);
                }
                (Self::with_sign(root >> up, false), Some(unit))
            }
            #[inline(always)]
            fn unit(v: Axes<Self::Signal>) -> Option<Axes<Self::Signal>> {
                Self::polar(v).1
            }
        }
    };
}
fixed_spatial!(Fixed32, word u32, int i32, wide u64, root root_64, root_high_64);
fixed_spatial!(Fixed16, word u16, int i16, wide u32, root root_32, root_high_32);
fixed_spatial!(Fixed8, word u8, int i8, wide u16, root root_16, root_high_16);

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
            fn share_of_length(u: Axes<$float>, length: $float) -> Axes<$float> {
                u.map(|part| part.abs() * length)
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
            fn along(u: Axes<$float>, v: Axes<$float>) -> $float {
                u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
            }
            #[inline(always)]
            fn length_down(v: Axes<$float>) -> $float {
                crate::number::Root::sqrt(Self::along(v, v))
            }
            #[inline(always)]
            fn length_up(v: Axes<$float>) -> $float {
                crate::number::Root::sqrt(Self::along(v, v))
            }
            #[inline(always)]
            fn longer(v: Axes<$float>, limit: $float) -> bool {
                Self::along(v, v) > limit * limit
            }
            #[inline(always)]
            fn three_quarters(x: $float) -> $float {
                0.75 * x
            }
            #[inline(always)]
            fn shortened(v: Axes<$float>, part: $float, whole: $float) -> Axes<$float> {
                v.map(|x| x * (part / whole))
            }
            #[inline(always)]
            fn root_of_squares(e: $float) -> $float {
                <$float as Number>::root(e)
            }
            #[inline(always)]
            fn across(u: Axes<$float>, v: Axes<$float>) -> Axes<$float> {
                let along = Self::along(u, v);
                let [x, y, z] = u.map(|u| along * u);
                [v[0] - x, v[1] - y, v[2] - z]
            }
            #[inline]
            fn turned(
                u: Axes<$float>,
                towards: Axes<$float>,
                [cosine, sine]: [$float; 2],
            ) -> Option<Axes<$float>> {
                let cross = |[ax, ay, az]: Axes<$float>, [bx, by, bz]: Axes<$float>| {
                    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
                };
                let side = Self::unit(cross(u, cross(towards, u)))?;
                let part = |i: usize| cosine * u[i] + sine * side[i];
                Self::unit([part(0), part(1), part(2)])
            }
            #[inline]
            fn polar(v: Axes<$float>) -> ($float, Option<Axes<$float>>) {
                let length = Self::length_down(v);
                (length, (length > 0.0).then(|| v.map(|x| x / length)))
            }
            #[inline]
            fn unit(v: Axes<$float>) -> Option<Axes<$float>> {
                Self::polar(v).1
            }
        }
    };
}
#[cfg(feature = "float")]
float_spatial!(f32);
#[cfg(feature = "float")]
float_spatial!(f64);
