//! The multiplications, divisions and roots of the control laws, on **unsigned words** (absolute values). The machine-checked
//! proofs are about these functions.
//!
//! A solver does not finish on signed products and quotients at full width, but proves the same facts about absolute values in
//! seconds. So these functions use `u8`/`u16`/`u32` words, with products in the next width. The signed [`Number`] functions only
//! add signs to them. A test checks the same source at 8 bits for every input.
//!
//! [`Number`]: crate::Number

use crate::division;
use core::fmt::Debug;
use core::hint::cold_path;

/// An unsigned integer (word) of 8, 16 or 32 bits, and the integer of twice the width, which holds products without loss.
pub trait Word: Copy + Debug + Ord + 'static {
    /// An integer of twice the width.
    type Wide: Copy + Debug + Ord + 'static;
    /// Number of bits of the word.
    const BITS: u32;
    /// The number zero.
    const ZERO: Self;
    /// The largest absolute value of a signed word of this width: `2^(BITS-1) - 1`.
    const MAX_SIGNED: Self;
    /// Zero in the double width.
    const WIDE_ZERO: Self::Wide;
    /// The integer 1 in the double width.
    const WIDE_ONE: Self::Wide;
    /// The largest absolute value of a signed word of twice the width.
    const WIDE_MAX_SIGNED: Self::Wide;

    /// The exact product of two words.
    fn times(self, other: Self) -> Self::Wide;
    /// Returns the quotient `q = floor(wide / self)` and the product `q · self`. For `self = 0` the quotient is 0.
    fn divides(self, wide: Self::Wide) -> (Self::Wide, Self::Wide);
    /// [`Word::divides`] for a quotient of at most `MAX_SIGNED`: `None` if the quotient is larger.
    fn divides_within(self, wide: Self::Wide) -> Option<(Self, Self::Wide)>;
    /// `wide` as a word of single width, limited to `MAX_SIGNED`.
    fn narrow(wide: Self::Wide) -> Self;
    /// The word, limited to `MAX_SIGNED`.
    fn at_most_signed(self) -> Self;
    /// The word converted to the double width.
    fn widen(self) -> Self::Wide;
    /// The bitwise OR of the two words.
    fn with(self, bit: Self) -> Self;
    /// The word `2^position`, a single bit.
    fn bit(position: u32) -> Self;
    /// `wide >> bits`: `wide` divided by `2^bits`, rounded down.
    fn shift_down(wide: Self::Wide, bits: u32) -> Self::Wide;
    /// `a - b`, 0 if `b` is larger.
    fn minus(a: Self::Wide, b: Self::Wide) -> Self::Wide;
    /// `a + b`, limited to `WIDE_MAX_SIGNED`.
    fn plus(a: Self::Wide, b: Self::Wide) -> Self::Wide;
}

macro_rules! word {
    ($word:ty, $wide:ty, $divide:ident, $quotient:expr, $short:expr) => {
        /// Returns `(q, q · by)` with `q = floor(wide / by)`; for `by = 0` both are 0.
        ///
        /// The function returns the product with the quotient, so that no caller multiplies a second time. In this form a solver
        /// can follow the callers.
        #[inline(always)]
        pub fn $divide(wide: $wide, by: $word) -> ($wide, $wide) {
            match $quotient(wide, by) {
                // q · by <= wide, so the product cannot overflow.
                Some(q) => (q, q.wrapping_mul(<$wide>::from(by))),
                None => (0, 0),
            }
        }

        impl Word for $word {
            type Wide = $wide;
            const BITS: u32 = <$word>::BITS;
            const ZERO: Self = 0;
            const MAX_SIGNED: Self = <$word>::MAX >> 1;
            const WIDE_ZERO: $wide = 0;
            const WIDE_ONE: $wide = 1;
            const WIDE_MAX_SIGNED: $wide = <$wide>::MAX >> 1;

            #[inline(always)]
            fn times(self, other: Self) -> $wide {
                // The product of two words always fits the double width.
                <$wide>::from(self).wrapping_mul(<$wide>::from(other))
            }
            #[inline(always)]
            fn divides(self, wide: $wide) -> ($wide, $wide) {
                $divide(wide, self)
            }
            #[inline(always)]
            fn divides_within(self, wide: $wide) -> Option<(Self, $wide)> {
                // A comparison before the division finds whether the quotient reaches 2^(BITS-1).
                if wide >= <$wide>::from(self) << (Self::BITS - 1) {
                    return if self == 0 { Some((0, 0)) } else { None };
                }
                Some($short(wide, self))
            }
            #[inline(always)]
            fn narrow(wide: $wide) -> Self {
                if wide <= <$wide>::from(Self::MAX_SIGNED) {
                    wide as $word
                } else {
                    cold_path();
                    Self::MAX_SIGNED
                }
            }
            #[inline(always)]
            fn at_most_signed(self) -> Self {
                if self <= Self::MAX_SIGNED {
                    self
                } else {
                    cold_path();
                    Self::MAX_SIGNED
                }
            }
            #[inline(always)]
            fn widen(self) -> $wide {
                <$wide>::from(self)
            }
            #[inline(always)]
            fn with(self, bit: Self) -> Self {
                self | bit
            }
            #[inline(always)]
            fn bit(position: u32) -> Self {
                (1 as $word).wrapping_shl(position)
            }
            #[inline(always)]
            fn shift_down(wide: $wide, bits: u32) -> $wide {
                wide.wrapping_shr(bits)
            }
            #[inline(always)]
            fn minus(a: $wide, b: $wide) -> $wide {
                a.saturating_sub(b)
            }
            #[inline(always)]
            fn plus(a: $wide, b: $wide) -> $wide {
                a.saturating_add(b).min(Self::WIDE_MAX_SIGNED)
            }
        }
    };
}

word!(
    u8,
    u16,
    divide_u8,
    |wide: u16, by: u8| wide.checked_div(by.into()),
    |wide: u16, by: u8| {
        let quotient = wide.checked_div(by.into()).unwrap_or(0);
        (
            <u8 as Word>::narrow(quotient),
            quotient.wrapping_mul(by.into()),
        )
    }
);
word!(
    u16,
    u32,
    divide_u16,
    |wide: u32, by: u16| wide.checked_div(by.into()),
    |wide: u32, by: u16| {
        let quotient = wide.checked_div(by.into()).unwrap_or(0);
        (
            <u16 as Word>::narrow(quotient),
            quotient.wrapping_mul(by.into()),
        )
    }
);
// A machine without a 64-bit division makes two or three 32-bit divisions instead.
word!(
    u32,
    u64,
    divide_u32,
    division::quotient,
    division::short_quotient
);

/// Result of a passivity step, which bounds a force by stored energy: the energy left, and the largest force allowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Step<W: Word> {
    /// Stored energy after the step.
    pub energy: W::Wide,
    /// Absolute value of the allowed force.
    pub force: W,
}

/// Bounds a force so that its work over a known displacement never exceeds the stored energy (equations 2.1–2.4 of the thesis, on
/// absolute values).
///
/// `inward` says that the displacement is against the force, so that the wall absorbs energy. Otherwise the wall gives energy
/// away. If the stored energy does not suffice, the force becomes the quotient of energy and displacement, rounded towards zero.
/// The energy left is **the remainder of that division**, `0 <= energy' < moved`, so nothing is multiplied a second time.
///
/// For every input: `energy' <= energy + force'·moved` inward (equal unless the sum saturates), `energy' = energy - force'·moved`
/// outward, `force' <= force`, no overflow.
#[inline(always)]
pub fn passivity_step<W: Word>(energy: W::Wide, force: W, moved: W, inward: bool) -> Step<W> {
    let work = force.times(moved);
    if inward {
        return Step {
            energy: W::plus(energy, work),
            force,
        };
    }
    if work <= energy {
        return Step {
            energy: W::minus(energy, work),
            force,
        };
    }
    // work > energy >= 0, so `moved` is not zero here.
    let (quotient, accounted) = moved.divides(energy);
    let force = W::narrow(quotient).min(force);
    Step {
        energy: W::minus(energy, accounted),
        force,
    }
}

/// Result of [`affordable`]: how far a force may push a body out until its work uses up the stored energy, and the energy left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Retreat<W: Word> {
    /// Distance for which the energy suffices: `floor(energy / force)`, saturating.
    pub moved: W,
    /// Energy left: `energy - force · moved`, never negative.
    pub rest: W::Wide,
}

/// How far the full force may push a body outward until its work uses up the stored energy, and the energy left (the remainder of
/// the division of energy by force).
///
/// For every input with a force: `force·moved + rest = energy`. With a force of 0 the displacement is 0.
#[inline(always)]
pub fn affordable<W: Word>(energy: W::Wide, force: W) -> Retreat<W> {
    let (quotient, accounted) = force.divides(energy);
    if quotient <= W::MAX_SIGNED.widen() {
        return Retreat {
            moved: W::narrow(quotient),
            rest: W::minus(energy, accounted),
        };
    }
    // The energy suffices for more than the largest distance of the format: the distance is limited, and the work over it is less
    // than the energy.
    Retreat {
        moved: W::MAX_SIGNED,
        rest: W::minus(energy, force.times(W::MAX_SIGNED)),
    }
}

/// State of a square root that is calculated digit by digit: the root of the digits found so far, and its square.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Root<W: Word> {
    /// The binary digits of the root that are found so far, from the highest down.
    pub root: W,
    /// The square of `root`, never above the radicand.
    pub square: W::Wide,
}

/// One step of a square root. The candidate is the root so far with one more binary digit. Returns the candidate if its square does
/// not exceed the radicand, else the root so far.
#[inline(always)]
pub fn root_digit<W: Word>(so_far: Root<W>, radicand: W::Wide, candidate: W) -> Root<W> {
    let square = candidate.times(candidate);
    if square <= radicand {
        Root {
            root: candidate,
            square,
        }
    } else {
        so_far
    }
}

/// `floor(sqrt(radicand))`, computed digit by digit from the highest: one product and one comparison per digit, no division.
#[inline]
pub fn root<W: Word>(radicand: W::Wide) -> Root<W> {
    let mut found = Root {
        root: W::ZERO,
        square: W::WIDE_ZERO,
    };
    for position in (0..W::BITS).rev() {
        let candidate = found.root.with(W::bit(position));
        found = root_digit(found, radicand, candidate);
    }
    found
}

/// `floor(gain · x)`, limited to the range of a word. `gain` is a fixed-point number with `bits` fractional bits.
#[inline(always)]
pub fn scale<W: Word>(gain: W, x: W, bits: u32) -> W {
    W::narrow(W::shift_down(gain.times(x), bits))
}

/// `floor(wide / divisor)`, limited to the range of a word.
#[inline(always)]
pub fn quotient<W: Word>(wide: W::Wide, divisor: W) -> W {
    divisor
        .divides_within(wide)
        .map_or(W::MAX_SIGNED, |(quotient, _)| quotient.at_most_signed())
}
