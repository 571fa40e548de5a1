//! Specification ticks: each law and the guard once more, over integers of 128 bits in which nothing saturates but where it says
//! so. No `Number`, nothing of what the code is made of: read each file beside the thesis' equations. The tests in
//! `proofs/tests/spec_*.rs` compare code and specification bit for bit, force and whole memory; `proofs/src/refines.rs` proves the
//! same. The same text at 8 bits is [`at8`].
//!
//! All numbers are counts of quanta of the 32-bit formats: signals (positions, forces) have 24 fractional bits, gains
//! (stiffnesses) 12, ratios 24, energies 48.

#[allow(clippy::duplicate_mod, reason = "the same text at another width")]
pub mod at8;
pub mod control_tick;
#[cfg(not(kani))]
pub mod covers;
pub mod enhanced;
pub mod estimator;
pub mod estimator_settings;
pub mod fba;
pub mod friction_settings;
pub mod guard;
pub mod guard_settings;
#[cfg(not(kani))]
pub mod hands;
pub mod law_settings;
mod rounding;
pub mod settings;
pub mod sfa;
pub mod tdpa;
pub mod velocity;
pub mod window;

pub use rounding::{cut, damping_loss, signal, spring, towards_zero};

/// The integers of this specification.
pub type Int = i128;
/// Bits of a signal.
pub const BITS: u32 = 32;
/// Fractional bits of a signal.
pub const SIGNAL: u32 = 24;
/// Fractional bits of a gain.
pub const GAIN: u32 = 12;
/// The highest signal.
pub const HIGHEST: Int = (1 << 31) - 1;
/// The lowest signal.
pub const LOWEST: Int = -(1 << 31);
/// The lowest energy: a deficit of 32 kJ is cut off there.
pub const LOWEST_ENERGY: Int = i64::MIN as Int;

/// `a b`, of two words; [`at8::times`] is the 8-bit form.
#[must_use]
pub fn times(a: Int, b: Int) -> Int {
    a * b
}

/// `a / b` of numbers that are not negative; [`at8::over`] is the 8-bit form.
#[must_use]
pub fn over(a: Int, b: Int) -> Int {
    a / b
}
