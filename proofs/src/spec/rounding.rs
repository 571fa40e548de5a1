//! Rounding and saturation as the specifications of all laws use them.

use super::{GAIN, HIGHEST, Int, LOWEST, over, times};

/// The quotient of two integers, rounded towards zero.
#[must_use]
pub fn towards_zero(dividend: Int, divisor: Int) -> Int {
    let size = over(dividend.abs(), divisor);
    if dividend < 0 { -size } else { size }
}

/// Divides by `2^digits` and rounds towards zero.
#[must_use]
pub fn cut(dividend: Int, digits: u32) -> Int {
    let size = dividend.abs() >> digits;
    if dividend < 0 { -size } else { size }
}

/// A number limited to the range of signals (positions and forces).
#[must_use]
pub fn signal(x: Int) -> Int {
    x.clamp(LOWEST, HIGHEST)
}

/// The force of a spring at a position, rounded towards zero and limited to the range of forces.
#[must_use]
pub fn spring(stiffness: Int, position: Int) -> Int {
    cut(times(stiffness, position), GAIN).clamp(-HIGHEST, HIGHEST)
}

/// The energy that a damper dissipates over one displacement: damping per tick times the displacement squared, with the force
/// rounded towards zero.
#[must_use]
pub fn damping_loss(damping: Int, moved: Int) -> Int {
    times(spring(damping, moved), moved)
}
