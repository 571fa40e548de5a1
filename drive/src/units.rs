//! Conversions between the settings' wide values and the narrow ones of the ticks; none overflows, none panics.

use fixed::types::I16F16;
use touchstone_control::Si;

pub(crate) use touchstone_control::quotient::quotient;

/// Settings are `I32F32`, currents and voltages `I16F16`: half the fraction, saturating.
pub(crate) const fn narrow(value: Si) -> I16F16 {
    I16F16::from_bits(clamp_i32(value.to_bits() >> 16))
}

/// The nearest value that fits.
#[inline(always)]
pub(crate) const fn clamp_i32(value: i64) -> i32 {
    let low = value as i32;
    // One comparison instead of two: this is in every product of the current loop.
    if low as i64 == value {
        low
    } else if value < 0 {
        i32::MIN
    } else {
        i32::MAX
    }
}

/// `a · b` with `shift` fractional bits taken off, towards minus infinity, saturating. For `shift` below 64.
#[inline(always)]
#[must_use]
pub const fn product(a: i32, b: i32, shift: u32) -> i32 {
    clamp_i32((a as i64 * b as i64) >> shift)
}

/// A share of a way, in 1/65,536, to the nearest. The way lies between two words.
#[inline(always)]
#[must_use]
pub const fn share_of(way: i64, share: u16) -> i64 {
    (way * share as i64 + (1 << 15)) >> 16
}

/// Thousandths of a value with 16 fractional bits, saturating: mA of A, mV of V.
pub(crate) const fn milli(value: I16F16) -> i32 {
    clamp_i32((value.to_bits() as i64 * 1000) >> 16)
}
