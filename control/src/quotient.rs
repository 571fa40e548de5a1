//! Divisions of settings. No tick makes one: each is long, of 128 bits, and the smaller board's flash is short, so there is one of each in
//! a program.

use crate::Si;

/// `a / b` towards zero, saturating; the largest value with the sign of `a` for `b = 0`.
#[cold]
#[inline(never)]
#[must_use]
pub fn quotient(a: Si, b: Si) -> Si {
    if b == Si::ZERO {
        if a < Si::ZERO { Si::MIN } else { Si::MAX }
    } else {
        a.saturating_div(b)
    }
}

/// `a / b` for a divisor that is meant to be positive; for any other the largest value.
pub(crate) fn over(a: Si, b: Si) -> Si {
    if b <= Si::ZERO {
        Si::MAX
    } else {
        quotient(a, b)
    }
}
