//! Conversions between the wide fixed-point numbers of settings and the narrow ones of the control interrupt. None of them
//! overflows or panics.

use fixed::types::I16F16;
use touchstone_control::Si;

pub(crate) use touchstone_control::quotient::quotient;

/// Converts a setting (`I32F32`) to a current or voltage (`I16F16`): half of the fractional bits, saturating.
pub(crate) const fn narrow(value: Si) -> I16F16 {
    I16F16::from_bits(clamp_i32(value.to_bits() >> 16))
}

/// The value limited to the range of an `i32`.
#[inline(always)]
pub(crate) const fn clamp_i32(value: i64) -> i32 {
    let low = value as i32;
    // One comparison instead of two, because every product of the current loop calls this.
    if low as i64 == value {
        low
    } else if value < 0 {
        i32::MIN
    } else {
        i32::MAX
    }
}

/// `a · b` shifted right by `shift` bits (below 64), rounded down, saturating.
#[inline(always)]
#[must_use]
pub const fn product(a: i32, b: i32, shift: u32) -> i32 {
    clamp_i32((a as i64 * b as i64) >> shift)
}

/// The product of the difference `way` of two 32-bit numbers and the fraction `share` in 1/65,536, rounded to the nearest.
#[inline(always)]
#[must_use]
pub const fn share_of(way: i64, share: u16) -> i64 {
    (way * share as i64 + (1 << 15)) >> 16
}

/// Converts a value with 16 fractional bits to thousandths, saturating: A to mA, V to mV.
pub(crate) const fn milli(value: I16F16) -> i32 {
    clamp_i32((value.to_bits() as i64 * 1000) >> 16)
}
