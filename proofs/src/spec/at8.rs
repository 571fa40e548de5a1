//! The same specification, from the same source text, with 8-bit number formats. Signals (positions, forces) and ratios have 7
//! fractional bits, gains (stiffnesses) 3, energies 14. An `i32` is wide enough that nothing saturates in it, except where the text
//! says so. It is also narrow enough for a solver.

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

/// Integer type in which the 8-bit specification calculates.
pub type Int = i32;
/// Number of bits of a signal (position or force).
pub const BITS: u32 = 8;
/// Number of fractional bits of a signal (position or force).
pub const SIGNAL: u32 = 7;
/// Number of fractional bits of a gain (stiffness).
pub const GAIN: u32 = 3;
/// The highest signal (position or force), in steps of the number format.
pub const HIGHEST: i32 = (1 << 7) - 1;
/// The lowest signal (position or force), in steps of the number format.
pub const LOWEST: i32 = -(1 << 7);
/// The lowest energy, in steps of the number format.
pub const LOWEST_ENERGY: i32 = -(1 << 15);

/// The product `a b` of two 16-bit words, which must fit 16 bits as well. The multiplication is no wider than needed, so that a
/// solver can follow it.
///
/// # Panics
/// A factor or the product does not fit 16 bits.
#[must_use]
pub fn times(a: Int, b: Int) -> Int {
    let half = |x: Int| i16::try_from(x).expect("a word");
    i32::from(half(a) * half(b))
}

/// The quotient `a / b` of two 16-bit words that are not negative: narrow enough for a solver to follow.
///
/// # Panics
/// `a` or `b` is negative or does not fit 16 bits, or `b` is 0.
#[must_use]
pub fn over(a: Int, b: Int) -> Int {
    let half = |x: Int| u16::try_from(x).expect("a word that is not negative");
    i32::from(half(a) / half(b))
}
