//! The same specification ticks, by the same text, of the 8-bit formats: signals and ratios have 7 fractional bits, gains 3, energies
//! 14. Integers of 32 bits are wide enough that nothing in them saturates but where it says so, and narrow enough for a solver.

#[path = "enhanced.rs"]
pub mod enhanced;
#[path = "fba.rs"]
pub mod fba;
#[path = "guard.rs"]
pub mod guard;
#[path = "rounding.rs"]
mod rounding;
#[path = "sfa.rs"]
pub mod sfa;
#[path = "tdpa.rs"]
pub mod tdpa;

pub use rounding::{cut, damping_loss, signal, spring, towards_zero};

/// The integers of this specification.
pub type Int = i32;
/// Bits of a signal.
pub const BITS: u32 = 8;
/// Fractional bits of a signal.
pub const SIGNAL: u32 = 7;
/// Fractional bits of a gain.
pub const GAIN: u32 = 3;
/// The highest signal.
pub const HIGHEST: i32 = (1 << 7) - 1;
/// The lowest signal.
pub const LOWEST: i32 = -(1 << 7);
/// The lowest energy.
pub const LOWEST_ENERGY: i32 = -(1 << 15);

/// `a b`, of two words, which 16 bits hold: no wider than it must be, for a solver's sake. Of anything else it panics.
///
/// # Panics
/// If a factor or the product is no word of 16 bits.
#[must_use]
pub fn times(a: Int, b: Int) -> Int {
    let half = |x: Int| i16::try_from(x).expect("a word");
    i32::from(half(a) * half(b))
}

/// `a / b` for words of 16 bits that are not negative, so that a solver follows it.
///
/// # Panics
/// If one of them is no such word, or `b` is 0.
#[must_use]
pub fn over(a: Int, b: Int) -> Int {
    let half = |x: Int| u16::try_from(x).expect("a word that is not negative");
    i32::from(half(a) / half(b))
}
