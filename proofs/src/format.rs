//! Number formats as the proofs use them: values with any bits, and the bits of a value as an `i64`.

use core::ops::{Add, Mul, Neg, Shl, Shr, Sub};

use crate::facts::Facts32;
use crate::functions::Functions32;
use crate::source::Source;
use touchstone_control::{
    Compliance, Energy, Fixed8, Fixed16, Fixed32, Force, Number, Position, Ratio, Stiffness,
    Tension,
};

/// Integers that are wide enough for exact sums of a format's products.
pub trait Exact:
    Copy
    + Ord
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Neg<Output = Self>
    + Shl<u32, Output = Self>
    + Shr<u32, Output = Self>
{
}
impl Exact for i128 {}
impl Exact for i32 {}

/// A number format whose values a property can choose freely and read as bits.
pub trait Format: Number {
    /// Number of bits of a signal (position or force).
    const BITS: u32;
    /// Number of fractional bits of a gain (stiffness).
    const GAIN_BITS: u32;
    /// Half the largest gain (stiffness), as an integer, rounded down.
    const HALF_GAIN: i64;
    /// The lowest signal (position or force).
    const LOWEST: Self::Signal;
    /// The highest signal (position or force).
    const HIGHEST: Self::Signal;
    /// Number of fractional bits of a signal (position or force).
    const SIGNAL_BITS: u32;
    /// Integer type of four times the width of a signal (position or force). It is no wider, as each further bit costs a solver
    /// much time.
    type Exact: Exact;
    /// Converts bits to the integer type [`Format::Exact`].
    fn exact(bits: i64) -> Self::Exact;
    /// A position with any bits, from the source of inputs.
    fn any_position<S: Source>(s: &mut S) -> Position<Self>;
    /// A force with any bits, from the source of inputs.
    fn any_force<S: Source>(s: &mut S) -> Force<Self>;
    /// A stiffness with any bits, from the source of inputs. It may be negative, which no setting allows.
    fn any_stiffness<S: Source>(s: &mut S) -> Stiffness<Self>;
    /// A compliance with any bits, from the source of inputs.
    fn any_compliance<S: Source>(s: &mut S) -> Compliance<Self>;
    /// A ratio with any bits, from the source of inputs.
    fn any_ratio<S: Source>(s: &mut S) -> Ratio<Self>;
    /// An energy with any bits, from the source of inputs.
    fn any_energy<S: Source>(s: &mut S) -> Energy<Self>;
    /// A tension (gain times signal) with any bits, from the source of inputs.
    fn any_tension<S: Source>(s: &mut S) -> Tension<Self>;
    /// The bits of a position or force as an integer.
    fn of_signal(x: Self::Signal) -> i64;
    /// The bits of a ratio or compliance as an integer.
    fn of_signal_ratio(x: Self::Ratio) -> i64;
    /// The bits of a stiffness as an integer.
    fn of_gain(x: Self::Gain) -> i64;
    /// The bits of an energy as an integer.
    fn of_energy(x: Self::Energy) -> i64;
    /// The bits of a tension as an integer.
    fn of_tension(x: Self::Product) -> i64;
    /// Largest energy that a law may store in the proofs: a quarter of the format's range.
    fn energy_cap() -> Energy<Self>;
}

macro_rules! format {
    ($name:ident, $word:ident, $wide:ident, $exact:ident) => {
        impl Format for $name {
            const BITS: u32 = $word::BITS;
            const GAIN_BITS: u32 = <$name as Number>::Gain::FRAC_NBITS;
            const HALF_GAIN: i64 = ($word::MAX >> 1) as i64;
            const LOWEST: Self::Signal = <$name as Number>::Signal::MIN;
            const HIGHEST: Self::Signal = <$name as Number>::Signal::MAX;
            const SIGNAL_BITS: u32 = <$name as Number>::Signal::FRAC_NBITS;
            type Exact = $exact;
            fn exact(bits: i64) -> $exact {
                bits as $exact
            }
            fn any_position<S: Source>(s: &mut S) -> Position<Self> {
                Position(<$name as Number>::Signal::from_bits(s.$word()))
            }
            fn any_force<S: Source>(s: &mut S) -> Force<Self> {
                Force(<$name as Number>::Signal::from_bits(s.$word()))
            }
            fn any_stiffness<S: Source>(s: &mut S) -> Stiffness<Self> {
                Stiffness(<$name as Number>::Gain::from_bits(s.$word()))
            }
            fn any_compliance<S: Source>(s: &mut S) -> Compliance<Self> {
                Compliance(<$name as Number>::Ratio::from_bits(s.$word()))
            }
            fn any_ratio<S: Source>(s: &mut S) -> Ratio<Self> {
                Ratio(<$name as Number>::Ratio::from_bits(s.$word()))
            }
            fn any_energy<S: Source>(s: &mut S) -> Energy<Self> {
                Energy(<$name as Number>::Energy::from_bits(s.$wide()))
            }
            fn any_tension<S: Source>(s: &mut S) -> Tension<Self> {
                Tension(s.$wide())
            }
            fn of_signal(x: Self::Signal) -> i64 {
                i64::from(x.to_bits())
            }
            fn of_signal_ratio(x: Self::Ratio) -> i64 {
                i64::from(x.to_bits())
            }
            fn of_gain(x: Self::Gain) -> i64 {
                i64::from(x.to_bits())
            }
            fn of_energy(x: Self::Energy) -> i64 {
                i64::from(x.to_bits())
            }
            fn of_tension(x: Self::Product) -> i64 {
                i64::from(x)
            }
            fn energy_cap() -> Energy<Self> {
                Energy(<$name as Number>::Energy::from_bits(($wide::MAX >> 1) + 1))
            }
        }
    };
}

format!(Fixed32, i32, i64, i128);
format!(Facts32, i32, i64, i128);
format!(Functions32, i32, i64, i128);
format!(Fixed16, i16, i32, i128);
format!(Fixed8, i8, i16, i32);
