//! The fixed-point number formats. Their signed functions use the unsigned arithmetic of [`crate::magnitude`] and add the signs.

use super::saturating::Saturates as _;
use super::{Number, Wide64};
use crate::Si;
use crate::magnitude::{self, Word};
use crate::reciprocal::Reciprocal32;
use core::hint::cold_path;
use fixed::types::{I1F7, I2F14, I4F28, I5F3, I8F24, I10F6, I16F48, I20F12};

/// 32-bit fixed-point formats, which the firmware uses.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Fixed32;
/// 16-bit fixed-point formats: half the memory, for knobs within ±2 rad.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Fixed16;
/// 8-bit fixed-point formats, small enough for a test of every input.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Fixed8;

/// An unsigned number that is used as a divisor, either directly or by a prepared reciprocal.
trait Divides<W: Word>: Sized {
    fn new(divisor: W) -> Self;
    fn quotient(&self, dividend: W::Wide) -> W;
}
/// A plain word uses the machine's division: if the machine can divide words of twice the width, a reciprocal saves nothing.
impl<W: Word> Divides<W> for W {
    fn new(divisor: W) -> W {
        divisor
    }
    #[inline(always)]
    fn quotient(&self, dividend: W::Wide) -> W {
        magnitude::quotient(dividend, *self)
    }
}
impl Divides<u32> for Reciprocal32 {
    fn new(divisor: u32) -> Self {
        Self::new(divisor)
    }
    #[inline(always)]
    fn quotient(&self, dividend: u64) -> u32 {
        self.quotient(dividend)
    }
}

macro_rules! fixed_number {
    ($name:ident, $text:literal, signal $signal:ty, gain $gain:ty, energy $energy:ty, word $word:ty, int $int:ty, wide $wide:ty, divisor $divisor:ty) => {
        impl $name {
            const GAIN_BITS: u32 = <$gain>::FRAC_NBITS;
            const SIGNAL_BITS: u32 = <$signal>::FRAC_NBITS;

            /// The signed value of an absolute value that is at most `MAX_SIGNED`.
            #[inline(always)]
            fn signed(magnitude: $word, negative: bool) -> $signal {
                debug_assert!(magnitude <= <$word as Word>::MAX_SIGNED);
                // The limit never binds; on 32-bit machines it makes the program smaller.
                let said = if cfg!(target_pointer_width = "32") {
                    magnitude.min(<$word as Word>::MAX_SIGNED)
                } else {
                    magnitude
                };
                let bits = said as $int;
                <$signal>::from_bits(if negative { bits.wrapping_neg() } else { bits })
            }

            /// A double word divided by `2^bits` and rounded down. The caller guarantees that the result fits the single width.
            #[inline(always)]
            fn shifted_fitting(wide: $wide, bits: u32) -> $signal {
                let shifted = wide >> bits;
                debug_assert!(<$int>::try_from(shifted).is_ok(), "{shifted} does not fit");
                <$signal>::from_bits(shifted as $int)
            }

            /// The signal (position or force) with these bits, limited to the largest or smallest signal.
            #[inline(always)]
            fn ended(bits: i64) -> $signal {
                <$signal>::from_bits(match <$int>::try_from(bits) {
                    Ok(bits) => bits,
                    Err(_) => {
                        cold_path();
                        if bits < 0 { <$int>::MIN } else { <$int>::MAX }
                    }
                })
            }

            #[inline(always)]
            fn magnitude(x: $signal) -> $word {
                x.to_bits().unsigned_abs()
            }

            /// Converts an SI value, which has 32 fractional bits, to an integer with `fraction` fractional bits, rounded towards
            /// zero.
            fn from_si(si: Si, fraction: u32) -> i64 {
                // Rounds towards zero, because the absolute value is shifted and not the number.
                let magnitude = si.to_bits().unsigned_abs();
                let shifted = if fraction <= 32 {
                    magnitude >> (32 - fraction)
                } else {
                    let up = fraction - 32;
                    if magnitude > (i64::MAX as u64) >> up {
                        i64::MAX as u64
                    } else {
                        magnitude << up
                    }
                };
                let bits = if shifted > i64::MAX as u64 {
                    i64::MAX
                } else {
                    shifted as i64
                };
                if si.is_negative() { -bits } else { bits }
            }
        }

        impl Number for $name {
            type Signal = $signal;
            type Gain = $gain;
            type Ratio = $signal;
            type Energy = $energy;
            type Product = $wide;
            type Divisor = $divisor;
            type Wide = Wide64;

            const NAME: &'static str = $text;
            const QUANTUM: $signal = <$signal>::DELTA;

            fn signal(si: Si) -> Option<$signal> {
                <$int>::try_from(Self::from_si(si, Self::SIGNAL_BITS))
                    .ok()
                    .map(<$signal>::from_bits)
            }
            #[inline]
            fn saturating_signal(si: Si) -> $signal {
                // Rounds towards zero: a shift rounds down, so a negative number is first raised by the digits that the shift
                // removes.
                let down = const { Si::FRAC_NBITS - Self::SIGNAL_BITS };
                let lost = (1_i64 << down) - 1;
                let bits = si.to_bits();
                Self::ended(bits.wrapping_add(bits >> (i64::BITS - 1) & lost) >> down)
            }
            fn gain(si: Si) -> Option<$gain> {
                if si.is_negative() {
                    return None;
                }
                <$int>::try_from(Self::from_si(si, Self::GAIN_BITS))
                    .ok()
                    .map(<$gain>::from_bits)
            }
            fn ratio(si: Si) -> Option<$signal> {
                if si.is_negative() {
                    None
                } else {
                    Self::signal(si)
                }
            }
            fn energy(si: Si) -> Option<$energy> {
                let bits = Self::from_si(si, <$energy>::FRAC_NBITS);
                if bits.unsigned_abs() >= i64::MAX as u64 {
                    return None;
                }
                <$wide>::try_from(bits).ok().map(<$energy>::from_bits)
            }

            #[inline(always)]
            fn add(a: $signal, b: $signal) -> $signal {
                <$signal>::from_bits(a.to_bits().sum(b.to_bits()))
            }
            #[inline(always)]
            fn sub(a: $signal, b: $signal) -> $signal {
                <$signal>::from_bits(a.to_bits().difference(b.to_bits()))
            }
            #[inline(always)]
            fn neg(a: $signal) -> $signal {
                <$signal>::from_bits(a.to_bits().opposite())
            }
            #[inline(always)]
            fn modulus(a: $signal) -> $signal {
                // Calculated from the absolute value, so that the compiler knows the sign of the result.
                Self::signed(Self::magnitude(a).at_most_signed(), false)
            }
            #[inline(always)]
            fn scale(r: $signal, x: $signal) -> $signal {
                // A ratio is never negative, so its bits are its absolute value.
                let size =
                    magnitude::scale(r.to_bits() as $word, Self::magnitude(x), Self::SIGNAL_BITS);
                Self::signed(size, x.is_negative())
            }

            #[inline(always)]
            fn product(k: $gain, x: $signal) -> $wide {
                // A product of two words fits the double width.
                <$wide>::from(k.to_bits()).wrapping_mul(<$wide>::from(x.to_bits()))
            }
            #[inline(always)]
            fn lift(x: $signal) -> $wide {
                // A word that is shifted up by fewer bits than a word has fits the double width.
                <$wide>::from(x.to_bits()).wrapping_shl(Self::GAIN_BITS)
            }
            #[inline(always)]
            fn add_product(a: $wide, b: $wide) -> $wide {
                a.sum(b)
            }
            #[inline(always)]
            fn sub_product(a: $wide, b: $wide) -> $wide {
                a.difference(b)
            }
            #[inline(always)]
            fn add_fitting(a: $wide, b: $wide) -> $wide {
                debug_assert!(a.checked_add(b).is_some(), "{a} + {b} does not fit");
                a.wrapping_add(b)
            }
            #[inline(always)]
            fn sub_fitting(a: $wide, b: $wide) -> $wide {
                debug_assert!(a.checked_sub(b).is_some(), "{a} - {b} does not fit");
                a.wrapping_sub(b)
            }
            #[inline(always)]
            fn positive_down(p: $wide) -> $signal {
                if p <= 0 {
                    return <$signal>::ZERO;
                }
                let shifted = <$word as Word>::shift_down(p.unsigned_abs(), Self::GAIN_BITS);
                Self::signed(<$word as Word>::narrow(shifted), false)
            }
            #[inline(always)]
            fn positive_up(p: $wide) -> $signal {
                if p <= 0 {
                    return <$signal>::ZERO;
                }
                // The absolute value of a signed double word leaves room in the unsigned one for the step that rounds up.
                let rounded = p.unsigned_abs().wrapping_add((1 << Self::GAIN_BITS) - 1);
                let shifted = <$word as Word>::shift_down(rounded, Self::GAIN_BITS);
                Self::signed(<$word as Word>::narrow(shifted), false)
            }
            #[inline(always)]
            fn round_to_zero(p: $wide) -> $signal {
                let size = <$word as Word>::narrow(<$word as Word>::shift_down(
                    p.unsigned_abs(),
                    Self::GAIN_BITS,
                ));
                Self::signed(size, p < 0)
            }
            #[inline(always)]
            fn round_up(p: $wide) -> $signal {
                // An arithmetic shift rounds down, so -floor(-p) rounds up. The one value without a negative saturates.
                let floor = p.saturating_neg() >> Self::GAIN_BITS;
                let ceiling = floor.saturating_neg();
                let size = <$word as Word>::narrow(ceiling.unsigned_abs());
                Self::signed(size, ceiling < 0)
            }
            #[inline(always)]
            fn divide(p: $wide, k: $gain) -> $signal {
                let size = magnitude::quotient(p.unsigned_abs(), k.to_bits().unsigned_abs());
                Self::signed(size, p < 0)
            }
            fn divisor(k: $gain) -> $divisor {
                <$divisor as Divides<$word>>::new(k.to_bits().unsigned_abs())
            }
            #[inline(always)]
            fn divide_by(p: $wide, k: &$divisor) -> $signal {
                Self::signed(Divides::<$word>::quotient(k, p.unsigned_abs()), p < 0)
            }

            #[inline(always)]
            fn widen(x: $signal) -> Wide64 {
                // A word with fewer fractional bits fits the double word without loss.
                let up = Wide64::FRACTION.wrapping_sub(Self::SIGNAL_BITS);
                Wide64(i64::from(x.to_bits()).wrapping_shl(up))
            }
            #[inline(always)]
            fn narrow(x: Wide64) -> $signal {
                let down = Wide64::FRACTION.wrapping_sub(Self::SIGNAL_BITS);
                let half = 1_i64.wrapping_shl(down.wrapping_sub(1));
                // The sum wraps only if the state is beyond the range, and the state's sign then tells on which side.
                let sum = x.0.wrapping_add(half);
                // Compares only the upper word, which is enough and takes fewer instructions on a 32-bit machine.
                let (high, limit) = ((sum >> 32) as i32, const { 1_i32 << (<$int>::BITS - 1 + Wide64::FRACTION - Self::SIGNAL_BITS - 32) });
                if high >= -limit && high < limit {
                    return <$signal>::from_bits((sum >> down) as $int);
                }
                cold_path();
                if x.0 < 0 { <$signal>::MIN } else { <$signal>::MAX }
            }

            #[inline(always)]
            fn work(f: $signal, d: $signal) -> $energy {
                <$energy>::from_bits(
                    <$wide>::from(f.to_bits()).wrapping_mul(<$wide>::from(d.to_bits())),
                )
            }
            #[inline(always)]
            fn add_energy(a: $energy, b: $energy) -> $energy {
                <$energy>::from_bits(a.to_bits().sum(b.to_bits()))
            }
            #[inline(always)]
            fn sub_energy(a: $energy, b: $energy) -> $energy {
                <$energy>::from_bits(a.to_bits().difference(b.to_bits()))
            }
            #[inline(always)]
            fn add_energy_fitting(a: $energy, b: $energy) -> $energy {
                debug_assert!(a.checked_add(b).is_some(), "{a} + {b} does not fit");
                a.wrapping_add(b)
            }
            #[inline(always)]
            fn sub_energy_fitting(a: $energy, b: $energy) -> $energy {
                debug_assert!(a.checked_sub(b).is_some(), "{a} - {b} does not fit");
                a.wrapping_sub(b)
            }
            #[inline(always)]
            fn energy_digits_fitting(e: $energy) -> $signal {
                // An energy has twice the fractional bits of a signal.
                Self::shifted_fitting(e.to_bits(), Self::SIGNAL_BITS)
            }
            #[inline(always)]
            fn modulus_fitting(a: $signal) -> $signal {
                debug_assert!(a != <$signal>::MIN, "the lowest value has no modulus");
                <$signal>::from_bits(a.to_bits().wrapping_abs())
            }
            #[inline(always)]
            fn scale_both_fitting(r: $signal, x: $signal, q: $signal, y: $signal) -> $signal {
                let sum = Self::add_energy_fitting(Self::work(r, x), Self::work(q, y));
                Self::shifted_fitting(sum.to_bits(), Self::SIGNAL_BITS)
            }
            #[inline(always)]
            fn round_down_fitting(p: $wide) -> $signal {
                Self::shifted_fitting(p, Self::GAIN_BITS)
            }
            #[inline(always)]
            fn half_energy_up(e: $energy) -> $energy {
                let bits = e.to_bits();
                <$energy>::from_bits((bits >> 1).saturating_add(bits & 1))
            }
            #[inline(always)]
            fn energy_per(e: $energy, x: $signal) -> $signal {
                let x = Self::magnitude(x);
                if x == 0 {
                    return <$signal>::MAX;
                }
                Self::signed(magnitude::quotient(e.to_bits().unsigned_abs(), x), false)
            }
            #[inline(always)]
            fn root(e: $energy) -> $signal {
                if e.is_negative() {
                    return <$signal>::ZERO;
                }
                let root = magnitude::root::<$word>(e.to_bits().unsigned_abs()).root;
                Self::signed(root.at_most_signed(), false)
            }
            fn root_of_four(k: $gain) -> $gain {
                // sqrt(4 k 2^-b) = sqrt(k 2^(2+b)) 2^-b for b fractional bits; the root of a word is far below the signed limit.
                let radicand = <$word as Word>::widen(k.to_bits().max(0).unsigned_abs())
                    .wrapping_shl(Self::GAIN_BITS + 2);
                let root = magnitude::root::<$word>(radicand).root;
                <$gain>::from_bits(root.min(<$word as Word>::MAX_SIGNED) as $int)
            }
            #[inline(always)]
            fn affordable(e: $energy, f: $signal) -> ($signal, $energy) {
                let energy = e.to_bits().max(0).unsigned_abs();
                let retreat = magnitude::affordable(energy, Self::magnitude(f));
                let rest = retreat.rest.min(<$word as Word>::WIDE_MAX_SIGNED) as $wide;
                (
                    Self::signed(retreat.moved, false),
                    <$energy>::from_bits(rest),
                )
            }

            #[inline(always)]
            fn passivity_step(e: $energy, f: $signal, d: $signal) -> ($energy, $signal) {
                // Negative energies and forces count as 0; the callers never pass them.
                let energy = e.to_bits().max(0).unsigned_abs();
                let force = Self::magnitude(f.max(<$signal>::ZERO));
                let step = magnitude::passivity_step::<$word>(
                    energy,
                    force,
                    Self::magnitude(d),
                    !d.is_negative(),
                );
                let bits = step.energy.min(<$word as Word>::WIDE_MAX_SIGNED) as $wide;
                (<$energy>::from_bits(bits), Self::signed(step.force, false))
            }
        }
    };
}

fixed_number!(Fixed32, "fixed32", signal I8F24, gain I20F12, energy I16F48, word u32, int i32, wide i64, divisor Reciprocal32);
fixed_number!(Fixed16, "fixed16", signal I2F14, gain I10F6, energy I4F28, word u16, int i16, wide i32, divisor u16);
fixed_number!(Fixed8, "fixed8", signal I1F7, gain I5F3, energy I2F14, word u8, int i8, wide i16, divisor u8);
