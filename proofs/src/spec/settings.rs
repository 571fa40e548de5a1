//! The arithmetic of settings in the specification. A setting is an integer in units of 2^-32 of its SI unit. Products and
//! quotients are rounded down, and no result exceeds the largest number. All numbers are at least 0, which validation ensures.

use super::{HIGHEST, Int};

/// The setting 1, in units of 2^-32.
pub const ONE: Int = 1 << 32;
/// The largest setting, in units of 2^-32.
pub const MOST: Int = i64::MAX as Int;

/// The sum `a + b`, at most the largest setting.
#[must_use]
pub fn plus(a: Int, b: Int) -> Int {
    (a + b).min(MOST)
}
/// The product `a b` of settings. When the model checker runs, [`crate::reckoned`] replaces it.
#[must_use]
pub fn times(a: Int, b: Int) -> Int {
    ((a * b) >> 32).min(MOST)
}
/// The quotient `a / b` of settings, and the largest setting if `b` is not above 0. When the model checker runs,
/// [`crate::reckoned`] replaces it.
#[must_use]
pub fn over(a: Int, b: Int) -> Int {
    if b <= 0 {
        MOST
    } else {
        ((a << 32) / b).min(MOST)
    }
}
/// Whether `least <= x <= most`.
#[must_use]
pub fn between(least: Int, x: Int, most: Int) -> bool {
    least <= x && x <= most
}

/// A setting converted to a position, force or ratio: 24 of its 32 fractional bits are kept.
#[must_use]
pub fn signal_of(x: Int) -> Int {
    x >> 8
}
/// A setting converted to a gain (stiffness): 12 of its 32 fractional bits are kept.
#[must_use]
pub fn gain_of(x: Int) -> Int {
    x >> 20
}
/// A setting converted to an energy: 16 zero bits follow its 32 fractional bits, since an energy has 48.
#[must_use]
pub fn energy_of(x: Int) -> Int {
    x << 16
}
/// Whether a setting, converted to a position or force, fits a word.
#[must_use]
pub fn signal_fits(x: Int) -> bool {
    signal_of(x) <= HIGHEST
}
/// Whether a setting, converted to a gain (stiffness), fits a word.
#[must_use]
pub fn gain_fits(x: Int) -> bool {
    gain_of(x) <= HIGHEST
}
/// Whether a setting, converted to an energy, fits a double word.
#[must_use]
pub fn energy_fits(x: Int) -> bool {
    x <= MOST >> 16
}
