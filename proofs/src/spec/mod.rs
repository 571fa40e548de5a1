//! Specification of each law and of the guard: every tick written a second time, over integers of 128 bits. Nothing saturates
//! except where the text says so. The specification uses no `Number` and nothing else of the code: read each file beside the
//! thesis' equations. The tests in `proofs/tests/spec_*.rs` compare code and specification bit for bit, force and whole memory.
//! `proofs/src/refines.rs` proves that they are equal. The same source text at 8 bits is [`at8`].
//!
//! All numbers are integers in steps of the 32-bit formats. Signals (positions, forces) have 24 fractional bits, gains
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

/// Integer type in which the 32-bit specification calculates.
pub type Int = i128;
/// Number of bits of a signal (position or force).
pub const BITS: u32 = 32;
/// Number of fractional bits of a signal (position or force).
pub const SIGNAL: u32 = 24;
/// Number of fractional bits of a gain (stiffness).
pub const GAIN: u32 = 12;
/// The highest signal (position or force), in steps of the number format.
pub const HIGHEST: Int = (1 << 31) - 1;
/// The lowest signal (position or force), in steps of the number format.
pub const LOWEST: Int = -(1 << 31);
/// The lowest energy, in steps of the energy format. A deficit below it (32 kJ) is limited to it.
pub const LOWEST_ENERGY: Int = i64::MIN as Int;

/// The product `a b` of two words; [`at8::times`] is its 8-bit form.
#[must_use]
pub fn times(a: Int, b: Int) -> Int {
    a * b
}

/// The quotient `a / b` of numbers that are not negative; [`at8::over`] is its 8-bit form.
#[must_use]
pub fn over(a: Int, b: Int) -> Int {
    a / b
}
