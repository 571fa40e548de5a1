//! What all specification ticks do with numbers.

use super::{GAIN, HIGHEST, Int, LOWEST, over, times};

/// The quotient rounded towards zero.
#[must_use]
pub fn towards_zero(dividend: Int, divisor: Int) -> Int {
    let size = over(dividend.abs(), divisor);
    if dividend < 0 { -size } else { size }
}

/// Rounds for a power of two as divisor: digits are cut off.
#[must_use]
pub fn cut(dividend: Int, digits: u32) -> Int {
    let size = dividend.abs() >> digits;
    if dividend < 0 { -size } else { size }
}

/// A number as a signal holds it: at the end of the format it stays there.
#[must_use]
pub fn signal(x: Int) -> Int {
    x.clamp(LOWEST, HIGHEST)
}

/// `k e`, a force: rounded towards zero, not beyond the format.
#[must_use]
pub fn spring(stiffness: Int, position: Int) -> Int {
    cut(times(stiffness, position), GAIN).clamp(-HIGHEST, HIGHEST)
}

/// `c Δ²`: the energy that a damper took over one displacement, the force rounded towards zero.
#[must_use]
pub fn damping_loss(damping: Int, moved: Int) -> Int {
    times(spring(damping, moved), moved)
}
