//! Number formats: the same laws in 32-bit, 16-bit and 8-bit fixed point and, for reference, in `f32` and `f64`.
//!
//! | format | position, force | stiffness, damping/T | energy | product gain × signal |
//! |---|---|---|---|---|
//! | [`Fixed32`] (default) | `I8F24`: ±128, step 6e-8 | `I20F12`: to 524,287, step 2.4e-4 | `I16F48` | 36 fractional bits in an `i64` |
//! | [`Fixed16`] | `I2F14`: ±2, step 6.1e-5 | `I10F6`: to 511, step 0.016 | `I4F28` | 20 fractional bits in an `i32` |
//! | [`Fixed8`] | `I1F7`: ±1 | `I5F3` | `I2F14` | 10 fractional bits in an `i16` |
//!
//! Force × displacement is an **exact** energy in every fixed format: twice the fractional bits, twice the width, no rounding.
//! Other results round towards zero, unless a function's comment says otherwise. (An arithmetic shift would round down: that is a
//! bias in one direction and not passive.) Additions saturate, except in the functions whose names end in `_fitting`. `Fixed8`
//! exists for tests of every input, not for use on devices.

mod fixed_point;
#[cfg(feature = "float")]
mod float;
#[cfg(feature = "float")]
mod reported;
mod saturating;
mod wide;

pub use fixed_point::{Fixed8, Fixed16, Fixed32};
#[cfg(feature = "float")]
pub(crate) use float::Root;
#[cfg(feature = "float")]
pub use reported::Reported;
pub(crate) use saturating::Saturates;
pub use wide::{Exact, Wide, Wide64, word_of};

use crate::Si;
use core::fmt::Debug;

/// Arithmetic of one number format. Every function except those ending in `_fitting` has a result for every input: it saturates
/// instead of overflowing and never panics.
///
/// "Towards zero" in the methods' comments is exact for the fixed formats. `f32` and `f64` round to nearest, as their operations
/// do.
pub trait Number: Copy + Debug + Default + PartialEq + 'static {
    /// Position, displacement or force.
    type Signal: Copy + Debug + Default + PartialEq + PartialOrd;
    /// Stiffness, damping per tick, or inertia per tick², all in N·m/rad (N/m). Never negative.
    type Gain: Copy + Debug + Default + PartialEq + PartialOrd;
    /// Dimensionless number or compliance (rad/(N·m), m/N). Never negative.
    type Ratio: Copy + Debug + Default + PartialEq + PartialOrd;
    /// Energy, J.
    type Energy: Copy + Debug + Default + PartialEq + PartialOrd;
    /// Gain × signal (stiffness × position) before rounding: a force with more fractional digits.
    type Product: Copy + Debug + Default + PartialEq + PartialOrd;
    /// A gain (stiffness) prepared as a divisor, for fast repeated divisions.
    type Divisor: Copy + Debug + Default + PartialEq;
    /// A displacement with far more digits than a signal (position or force), for the state of an estimator.
    type Wide: Wide;

    /// Name of the format in settings and results.
    const NAME: &'static str;

    /// The smallest positive signal (position or force); for floats, that of [`Fixed32`].
    const QUANTUM: Self::Signal;

    /// Converts an SI value to a signal (position or force), rounded towards zero; `None` outside the format.
    fn signal(si: Si) -> Option<Self::Signal>;
    /// Converts an SI value to a signal (position or force), rounded towards zero, saturating.
    fn saturating_signal(si: Si) -> Self::Signal;
    /// Converts an SI value to a gain (stiffness), rounded towards zero; `None` if negative or too large.
    fn gain(si: Si) -> Option<Self::Gain>;
    /// Converts an SI value to a ratio, rounded towards zero; `None` if negative or too large.
    fn ratio(si: Si) -> Option<Self::Ratio>;
    /// Converts a value in J to an energy, rounded towards zero; `None` outside the format.
    fn energy(si: Si) -> Option<Self::Energy>;

    /// `a + b`, saturating.
    fn add(a: Self::Signal, b: Self::Signal) -> Self::Signal;
    /// `a - b`, saturating.
    fn sub(a: Self::Signal, b: Self::Signal) -> Self::Signal;
    /// `-a`, saturating.
    fn neg(a: Self::Signal) -> Self::Signal;
    /// `|a|`, saturating.
    fn modulus(a: Self::Signal) -> Self::Signal;
    /// Ratio times signal, `r · x`, rounded towards zero, saturating.
    fn scale(r: Self::Ratio, x: Self::Signal) -> Self::Signal;

    /// Gain times signal, `k · x`, unrounded.
    fn product(k: Self::Gain, x: Self::Signal) -> Self::Product;
    /// Converts a signal (force) exactly to a product, as if multiplied by a gain of 1.
    fn lift(x: Self::Signal) -> Self::Product;
    /// `a + b`, saturating.
    fn add_product(a: Self::Product, b: Self::Product) -> Self::Product;
    /// `a - b`, saturating.
    fn sub_product(a: Self::Product, b: Self::Product) -> Self::Product;
    /// `a + b` without an overflow check; the caller guarantees that the sum fits.
    fn add_fitting(a: Self::Product, b: Self::Product) -> Self::Product;
    /// `a - b` without an overflow check; the caller guarantees that the difference fits.
    fn sub_fitting(a: Self::Product, b: Self::Product) -> Self::Product;
    /// Rounds a product (an unrounded force) to a signal towards zero, saturating.
    fn round_to_zero(p: Self::Product) -> Self::Signal;
    /// Rounds a product (an unrounded force) to a signal upwards (towards plus infinity), saturating.
    fn round_up(p: Self::Product) -> Self::Signal;
    /// [`Number::round_to_zero`] of a positive product; 0 for a product of 0 or less.
    fn positive_down(p: Self::Product) -> Self::Signal;
    /// [`Number::round_up`] of a positive product; 0 for a product of 0 or less.
    fn positive_up(p: Self::Product) -> Self::Signal;
    /// Product over gain, `p / k`, rounded towards zero, saturating; 0 for `k = 0`, which the validation of settings refuses.
    fn divide(p: Self::Product, k: Self::Gain) -> Self::Signal;
    /// Prepares a gain as a divisor. The preparation is slow: call it before the ticks, not in one.
    fn divisor(k: Self::Gain) -> Self::Divisor;
    /// [`Number::divide`] by the gain of the prepared divisor, with the same result bit by bit.
    fn divide_by(p: Self::Product, k: &Self::Divisor) -> Self::Signal;

    /// Converts a signal (position) exactly to the wide format of an estimator's state.
    fn widen(x: Self::Signal) -> Self::Wide;
    /// Converts an estimator's state to a signal (position), to nearest (halves up), saturating.
    fn narrow(x: Self::Wide) -> Self::Signal;

    /// Force × displacement, `f · d`, exact.
    fn work(f: Self::Signal, d: Self::Signal) -> Self::Energy;
    /// `a + b`, saturating.
    fn add_energy(a: Self::Energy, b: Self::Energy) -> Self::Energy;
    /// `a - b`, saturating.
    fn sub_energy(a: Self::Energy, b: Self::Energy) -> Self::Energy;
    /// `a + b` without an overflow check; the caller guarantees that the sum fits.
    fn add_energy_fitting(a: Self::Energy, b: Self::Energy) -> Self::Energy;
    /// `a - b` without an overflow check; the caller guarantees that the difference fits.
    fn sub_energy_fitting(a: Self::Energy, b: Self::Energy) -> Self::Energy;
    /// An energy rounded down (towards minus infinity) to the precision of a signal; the caller guarantees that it fits.
    fn energy_digits_fitting(e: Self::Energy) -> Self::Signal;
    /// `|a|` without an overflow check; the caller guarantees that it fits.
    fn modulus_fitting(a: Self::Signal) -> Self::Signal;
    /// `r · x + q · y` rounded down once; the caller guarantees that it fits.
    fn scale_both_fitting(
        r: Self::Ratio,
        x: Self::Signal,
        q: Self::Ratio,
        y: Self::Signal,
    ) -> Self::Signal;
    /// A product (an unrounded force) rounded down to a signal; the caller guarantees that it fits.
    fn round_down_fitting(p: Self::Product) -> Self::Signal;
    /// Half of a non-negative energy, rounded up.
    fn half_energy_up(e: Self::Energy) -> Self::Energy;
    /// Energy over displacement, `|e| / |x|`, rounded towards zero, saturating; the largest signal for `x = 0`.
    fn energy_per(e: Self::Energy, x: Self::Signal) -> Self::Signal;
    /// Square root of an energy: the largest signal whose square does not exceed `e`; 0 for a negative `e`.
    fn root(e: Self::Energy) -> Self::Signal;

    /// Square root of four times a gain, rounded down, in the format of a gain: its square never exceeds `4 k`.
    fn root_of_four(k: Self::Gain) -> Self::Gain;
    /// The distance of an outward motion under a force `f > 0` whose work uses up the energy `e >= 0`, rounded towards zero, and
    /// the energy left: `f · moved + rest = e`. See [`crate::magnitude::affordable`].
    fn affordable(e: Self::Energy, f: Self::Signal) -> (Self::Signal, Self::Energy);

    /// Bounds a force by stored energy. Takes the stored energy `e >= 0`, the requested force `f >= 0` and the displacement `d`
    /// (positive: inward, where the force absorbs energy). Returns the energy left and the allowed force. See
    /// [`crate::magnitude::passivity_step`].
    fn passivity_step(
        e: Self::Energy,
        f: Self::Signal,
        d: Self::Signal,
    ) -> (Self::Energy, Self::Signal);
}
