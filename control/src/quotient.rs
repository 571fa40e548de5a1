//! The number format of settings, and its divisions. These functions calculate with 128 bits and are slow, so control periods do not
//! use them. The division is compiled once and never inlined, because the smaller board has little flash.

/// An SI value in the fixed-point format `I32F32`: ±2.1e9 in steps of 2.3e-10.
pub type Si = fixed::types::I32F32;

/// `a / b` rounded towards zero, saturating. For `b = 0` it is the largest value with the sign of `a`.
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

/// `a / b` for a positive divisor; for a divisor of 0 or less the largest value.
pub(crate) fn over(a: Si, b: Si) -> Si {
    if b <= Si::ZERO {
        Si::MAX
    } else {
        quotient(a, b)
    }
}
