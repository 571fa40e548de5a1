//! Specification ticks: each law and the guard once more, over integers of 128 bits in which nothing saturates but where it says
//! so. No `Number`, nothing of what the code is made of: read each file beside the thesis' equations. The tests in
//! `proofs/tests/spec_*.rs` compare code and specification bit for bit, force and whole memory.
//!
//! All numbers are counts of quanta of the 32-bit formats: signals (positions, forces) have 24 fractional bits, gains
//! (stiffnesses) 12, ratios 24, energies 48.

pub mod enhanced;
pub mod fba;
pub mod guard;
#[cfg(not(kani))]
pub mod hands;
pub mod sfa;
pub mod tdpa;

/// Fractional bits of a signal.
pub const SIGNAL: u32 = 24;
/// Fractional bits of a gain.
pub const GAIN: u32 = 12;
/// The highest signal.
pub const HIGHEST: i128 = (1 << 31) - 1;
/// The lowest signal.
pub const LOWEST: i128 = -(1 << 31);

/// The quotient rounded towards zero.
#[must_use]
pub fn towards_zero(dividend: i128, divisor: i128) -> i128 {
    let size = dividend.abs() / divisor;
    if dividend < 0 { -size } else { size }
}

/// A number as a signal holds it: at the end of the format it stays there.
#[must_use]
pub fn signal(x: i128) -> i128 {
    x.clamp(LOWEST, HIGHEST)
}

/// `k e`, a force: rounded towards zero, not beyond the format.
#[must_use]
pub fn spring(stiffness: i128, position: i128) -> i128 {
    towards_zero(stiffness * position, 1 << GAIN).clamp(-HIGHEST, HIGHEST)
}

/// `c Δ²`, an energy: what a damper took over one displacement, the force rounded towards zero.
#[must_use]
pub fn damping_loss(damping: i128, moved: i128) -> i128 {
    spring(damping, moved) * moved
}
