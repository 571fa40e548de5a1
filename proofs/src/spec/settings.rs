//! The arithmetic of settings: a setting is a count of 2^-32 of its SI unit. Products and quotients are rounded down, and nothing is more
//! than the largest number. Of numbers that are not negative, which is what validation lets through.

use super::{HIGHEST, Int};

/// A setting of one.
pub const ONE: Int = 1 << 32;
/// The largest setting.
pub const MOST: Int = i64::MAX as Int;

/// `a + b`.
#[must_use]
pub fn plus(a: Int, b: Int) -> Int {
    (a + b).min(MOST)
}
/// `a b`; [`crate::reckoned`] says what the checker puts in its place.
#[must_use]
pub fn times(a: Int, b: Int) -> Int {
    ((a * b) >> 32).min(MOST)
}
/// `a / b`, the largest number for `b = 0`; [`crate::reckoned`] says what the checker puts in its place.
#[must_use]
pub fn over(a: Int, b: Int) -> Int {
    if b <= 0 {
        MOST
    } else {
        ((a << 32) / b).min(MOST)
    }
}
/// Whether a number lies between two others, or equals one of them.
#[must_use]
pub fn between(least: Int, x: Int, most: Int) -> bool {
    least <= x && x <= most
}

/// A setting as a signal or a ratio, with 24 of the 32 digits.
#[must_use]
pub fn signal_of(x: Int) -> Int {
    x >> 8
}
/// A setting as a gain, with 12 fractional bits.
#[must_use]
pub fn gain_of(x: Int) -> Int {
    x >> 20
}
/// A setting as an energy, with 48 fractional bits.
#[must_use]
pub fn energy_of(x: Int) -> Int {
    x << 16
}
/// Whether a word holds it as a signal.
#[must_use]
pub fn signal_fits(x: Int) -> bool {
    signal_of(x) <= HIGHEST
}
/// Whether a setting fits a gain.
#[must_use]
pub fn gain_fits(x: Int) -> bool {
    gain_of(x) <= HIGHEST
}
/// Whether a double word holds it as an energy.
#[must_use]
pub fn energy_fits(x: Int) -> bool {
    x <= MOST >> 16
}
