//! The numeric heart on **unsigned magnitudes**: what the proofs are about, and what they finish on.
//!
//! Signed products and quotients defeat every solver tried at full width; the same facts about magnitudes take seconds. So
//! the nonlinear steps live here, on `u8`/`u16`/`u32` words with products in the next width, and the signed [`Number`]
//! functions are thin edges around them. The same source at 8 bits is checked exhaustively.
//!
//! [`Number`]: crate::Number

use crate::division;
use core::fmt::Debug;

/// A word and the double-width word that holds its products without loss.
pub trait Word: Copy + Debug + Ord + 'static {
    /// Twice the width.
    type Wide: Copy + Debug + Ord + 'static;
    /// Number of bits of the word.
    const BITS: u32;
    /// Zero.
    const ZERO: Self;
    /// The largest magnitude of the signed word of this width: `2^(BITS-1) - 1`.
    const MAX_SIGNED: Self;
    /// Zero.
    const WIDE_ZERO: Self::Wide;
    /// One.
    const WIDE_ONE: Self::Wide;
    /// The largest magnitude of the signed double-width word.
    const WIDE_MAX_SIGNED: Self::Wide;

    /// The exact product.
    fn times(self, other: Self) -> Self::Wide;
    /// Quotient and the part of `wide` that it accounts for: `(q, q · self)` with `q = floor(wide / self)`.
    /// For `self = 0` the quotient is 0.
    fn divides(self, wide: Self::Wide) -> (Self::Wide, Self::Wide);
    /// `wide` as a word if it fits below the signed limit, else that limit.
    fn narrow(wide: Self::Wide) -> Self;
    /// The word in the double width.
    fn widen(self) -> Self::Wide;
    /// `floor(sqrt(wide))`.
    fn root(wide: Self::Wide) -> Self;
    /// `wide >> bits`, the floor of the quotient by a power of two.
    fn shift_down(wide: Self::Wide, bits: u32) -> Self::Wide;
    /// `a - b`, 0 where `b` is larger.
    fn minus(a: Self::Wide, b: Self::Wide) -> Self::Wide;
    /// `a + b`, at most the signed limit of the double width.
    fn plus(a: Self::Wide, b: Self::Wide) -> Self::Wide;
}

macro_rules! word {
    ($word:ty, $wide:ty, $quotient:expr) => {
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
                match $quotient(wide, self) {
                    // q · self <= wide, so the product cannot overflow.
                    Some(q) => (q, q.wrapping_mul(<$wide>::from(self))),
                    None => (0, 0),
                }
            }
            #[inline(always)]
            fn narrow(wide: $wide) -> Self {
                if wide <= <$wide>::from(Self::MAX_SIGNED) {
                    wide as $word
                } else {
                    Self::MAX_SIGNED
                }
            }
            #[inline(always)]
            fn widen(self) -> $wide {
                <$wide>::from(self)
            }
            #[inline(always)]
            fn root(wide: $wide) -> Self {
                // The square root of a double-width word fits the word.
                wide.isqrt() as $word
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

word!(u8, u16, |wide: u16, word: u8| wide.checked_div(word.into()));
word!(u16, u32, |wide: u32, word: u16| wide
    .checked_div(word.into()));
word!(u32, u64, division::quotient);

/// What a passivity step decides: the energy left, the force allowed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Step<W: Word> {
    /// Energy after the step.
    pub energy: W::Wide,
    /// Magnitude of the force allowed.
    pub force: W,
}

/// Passivity step with a displacement that is already known (thesis 2.1–2.4, in magnitudes).
///
/// `inward`: the displacement is against the force, so the wall absorbs. Otherwise the wall gives energy away: if the stored
/// energy does not suffice, the force becomes the quotient rounded towards zero and the energy left is **the remainder of
/// that very division**, `0 <= energy' < moved`: nothing is multiplied a second time.
///
/// For every input: `energy' <= energy + force'·moved` inward (equal below the cap), `energy' = energy - force'·moved`
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

/// How far a body may move outward against the full force before the stored energy is used up: `floor(energy / force)`.
#[inline(always)]
pub fn affordable<W: Word>(energy: W::Wide, force: W) -> W {
    W::narrow(force.divides(energy).0)
}

/// Largest force whose work over any next displacement is covered by the energy and the device's own damping
/// (thesis 2.7a): `floor(sqrt(energy)) · gain`, with `gain = floor(sqrt(4 c_i/T))` in `gain_bits` fractional bits.
#[inline(always)]
pub fn force_bound<W: Word>(energy: W::Wide, gain: W, gain_bits: u32) -> W {
    W::narrow(W::shift_down(W::root(energy).times(gain), gain_bits))
}

/// `floor(gain · x)` with `bits` fractional bits in the gain, saturating.
#[inline(always)]
pub fn scale<W: Word>(gain: W, x: W, bits: u32) -> W {
    W::narrow(W::shift_down(gain.times(x), bits))
}

/// `floor(wide / divisor)`, saturating to the word.
#[inline(always)]
pub fn quotient<W: Word>(wide: W::Wide, divisor: W) -> W {
    W::narrow(divisor.divides(wide).0)
}
