//! Quantities with their units in their types, so that the laws read like the equations.
//!
//! | type | unit (1-DoF / 3-DoF) |
//! |---|---|
//! | [`Position`] | rad / m |
//! | [`Force`] | N·m / N |
//! | [`Stiffness`], [`Divisor`] | N·m/rad / N/m; damping and inertia enter as `c/T` and `m/T²` in the same unit |
//! | [`Compliance`] | rad/(N·m) / m/N |
//! | [`Ratio`] | 1 |
//! | [`Energy`] | J |
//! | [`Tension`] | N·m / N, unrounded: stiffness × position before it becomes a [`Force`] |

#[cfg(feature = "float")]
mod reported;

use crate::{Number, Si};
use core::cmp::Ordering;
use core::ops::{Add, Mul, Neg, Sub};
use fixed::traits::LossyInto;

macro_rules! quantity {
    ($(#[$doc:meta])* $name:ident($inner:ident)) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, Default, PartialEq)]
        pub struct $name<N: Number>(pub N::$inner);

        impl<N: Number> PartialOrd for $name<N> {
            #[inline(always)]
            fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
                self.0.partial_cmp(&other.0)
            }
        }

        impl<N: Number> $name<N> {
            /// The quantity 0.
            #[inline(always)]
            #[must_use]
            pub fn zero() -> Self {
                Self(Default::default())
            }
            /// The smaller of two quantities of the same type.
            #[inline(always)]
            #[must_use]
            pub fn min(self, other: Self) -> Self {
                if other < self { other } else { self }
            }
            /// The larger of two quantities of the same type.
            #[inline(always)]
            #[must_use]
            pub fn max(self, other: Self) -> Self {
                if other > self { other } else { self }
            }
        }
    };
}

quantity!(
    /// Angle, position, penetration, displacement: rad (m).
    Position(Signal)
);
quantity!(
    /// Torque or force: N·m (N).
    Force(Signal)
);
quantity!(
    /// Stiffness, or damping per tick and inertia per tick²: N·m/rad (N/m).
    Stiffness(Gain)
);
quantity!(
    /// Compliance: rad/(N·m) (m/N).
    Compliance(Ratio)
);
quantity!(
    /// A dimensionless number.
    Ratio(Ratio)
);
quantity!(
    /// Energy: J. Positive means absorbed from the user.
    Energy(Energy)
);
quantity!(
    /// Stiffness times position before rounding to a force: N·m (N).
    Tension(Product)
);

macro_rules! signal_quantity {
    ($name:ident) => {
        impl<N: Number> Add for $name<N> {
            type Output = Self;
            #[inline(always)]
            fn add(self, other: Self) -> Self {
                Self(N::add(self.0, other.0))
            }
        }
        impl<N: Number> Sub for $name<N> {
            type Output = Self;
            #[inline(always)]
            fn sub(self, other: Self) -> Self {
                Self(N::sub(self.0, other.0))
            }
        }
        impl<N: Number> Neg for $name<N> {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self(N::neg(self.0))
            }
        }
        impl<N: Number> $name<N> {
            /// The smallest step of the number format.
            #[inline(always)]
            #[must_use]
            pub fn quantum() -> Self {
                Self(N::QUANTUM)
            }
            /// The modulus (absolute value).
            #[inline(always)]
            #[must_use]
            pub fn modulus(self) -> Self {
                Self(N::modulus(self.0))
            }
            /// The modulus (absolute value) without an overflow check; the caller guarantees that it fits.
            #[inline(always)]
            #[must_use]
            pub fn modulus_fitting(self) -> Self {
                Self(N::modulus_fitting(self.0))
            }
            /// The value limited to `-limit..=limit`.
            #[inline(always)]
            #[must_use]
            pub fn within(self, limit: Self) -> Self {
                self.min(limit).max(-limit)
            }
            /// Converts an SI value, rounding towards zero to a step of the format; `None` outside the format.
            #[must_use]
            pub fn from_si(si: Si) -> Option<Self> {
                N::signal(si).map(Self)
            }
            /// The exact value in SI units. Only the fixed-point formats have this method: each of their steps is a whole number of
            /// steps of [`Si`].
            #[must_use]
            pub fn to_si(self) -> Si
            where
                N::Signal: Into<Si>,
            {
                self.0.into()
            }
        }
    };
}
signal_quantity!(Position);
signal_quantity!(Force);

impl<N: Number> Mul<Position<N>> for Stiffness<N> {
    type Output = Tension<N>;
    #[inline(always)]
    fn mul(self, x: Position<N>) -> Tension<N> {
        Tension(N::product(self.0, x.0))
    }
}
impl<N: Number> Mul<Force<N>> for Compliance<N> {
    type Output = Position<N>;
    #[inline(always)]
    fn mul(self, f: Force<N>) -> Position<N> {
        Position(N::scale(self.0, f.0))
    }
}
impl<N: Number> Ratio<N> {
    /// This ratio times the displacement `x`, plus the deformation of `spring` under the force `f`. The sum is rounded down once.
    /// The caller guarantees that nothing overflows.
    #[inline(always)]
    #[must_use]
    pub fn of_and_fitting(self, x: Position<N>, spring: Compliance<N>, f: Force<N>) -> Position<N> {
        Position(N::scale_both_fitting(self.0, x.0, spring.0, f.0))
    }

    /// This fraction of a force, rounded towards zero.
    #[inline(always)]
    #[must_use]
    pub fn share_of_force(self, force: Force<N>) -> Force<N> {
        Force(N::scale(self.0, force.0))
    }
}
impl<N: Number> Mul<Position<N>> for Ratio<N> {
    type Output = Position<N>;
    #[inline(always)]
    fn mul(self, x: Position<N>) -> Position<N> {
        Position(N::scale(self.0, x.0))
    }
}
impl<N: Number> Mul<Position<N>> for Force<N> {
    type Output = Energy<N>;
    /// Work of this force over the displacement `d`, exact.
    #[inline(always)]
    fn mul(self, d: Position<N>) -> Energy<N> {
        Energy(N::work(self.0, d.0))
    }
}
impl<N: Number> Add for Energy<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(N::add_energy(self.0, other.0))
    }
}
impl<N: Number> Sub for Energy<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(N::sub_energy(self.0, other.0))
    }
}
impl<N: Number> Energy<N> {
    /// Converts an SI value exactly; `None` outside the format.
    #[must_use]
    pub fn from_si(si: Si) -> Option<Self> {
        N::energy(si).map(Self)
    }
    /// The value in J, rounded down to a step of [`Si`] (2.3e-10 J). Only the fixed-point formats have this method.
    #[must_use]
    pub fn to_si(self) -> Si
    where
        N::Energy: LossyInto<Si>,
    {
        self.0.lossy_into()
    }
    /// `self + other` without an overflow check; the caller guarantees that the sum fits.
    #[inline(always)]
    #[must_use]
    pub fn plus_fitting(self, other: Self) -> Self {
        Self(N::add_energy_fitting(self.0, other.0))
    }
    /// `self - other` without an overflow check; the caller guarantees that the difference fits.
    #[inline(always)]
    #[must_use]
    pub fn minus_fitting(self, other: Self) -> Self {
        Self(N::sub_energy_fitting(self.0, other.0))
    }
    /// The energy rounded down to the precision of a position, without an overflow check. Multiplied by a stiffness of value
    /// `1/d`, the result gives the force whose work over the distance `d` is this energy.
    #[inline(always)]
    #[must_use]
    pub fn digits_fitting(self) -> Position<N> {
        Position(N::energy_digits_fitting(self.0))
    }
    /// `|e| / |d|` rounded towards zero: the force whose work over the displacement `d` is at most this energy.
    #[inline(always)]
    #[must_use]
    pub fn per_displacement(self, d: Position<N>) -> Force<N> {
        Force(N::energy_per(self.0, d.0))
    }
    /// The distance of an outward motion under the force `f` whose work uses up this energy, and the energy left after rounding
    /// that distance towards zero.
    #[inline(always)]
    #[must_use]
    pub fn affordable(self, f: Force<N>) -> (Position<N>, Self) {
        let (moved, rest) = N::affordable(self.0, f.0);
        (Position(moved), Self(rest))
    }
}
impl<N: Number> Add for Tension<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(N::add_product(self.0, other.0))
    }
}
impl<N: Number> Sub for Tension<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(N::sub_product(self.0, other.0))
    }
}
/// A stiffness prepared as a divisor, so that each tick divides fast.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Divisor<N: Number>(pub N::Divisor);

impl<N: Number> Divisor<N> {
    /// Prepares a stiffness as a divisor. The preparation is slow: call it before the ticks, not in one.
    #[must_use]
    pub fn of(k: Stiffness<N>) -> Self {
        Self(N::divisor(k.0))
    }
}
impl<N: Number> Tension<N> {
    /// `self + other` without an overflow check; the caller guarantees that the sum fits.
    #[inline(always)]
    #[must_use]
    pub fn plus_fitting(self, other: Self) -> Self {
        Self(N::add_fitting(self.0, other.0))
    }
    /// `self - other` without an overflow check; the caller guarantees that the difference fits.
    #[inline(always)]
    #[must_use]
    pub fn minus_fitting(self, other: Self) -> Self {
        Self(N::sub_fitting(self.0, other.0))
    }
    /// The tension rounded down to a force, without an overflow check; the caller guarantees that it fits.
    #[inline(always)]
    #[must_use]
    pub fn down_fitting(self) -> Force<N> {
        Force(N::round_down_fitting(self.0))
    }
    /// The force that pushes out of the wall, rounded towards zero; 0 if the tension pulls inwards.
    #[inline(always)]
    #[must_use]
    pub fn outward(self) -> Force<N> {
        Force(N::positive_down(self.0))
    }
    /// The force that pushes out of the wall, rounded up; 0 if the tension pulls inwards.
    #[inline(always)]
    #[must_use]
    pub fn outward_up(self) -> Force<N> {
        Force(N::positive_up(self.0))
    }
    /// Stretch of a spring under this tension: [`Tension::over`] for a stiffness that is prepared as a divisor.
    #[inline(always)]
    #[must_use]
    pub fn per(self, k: &Divisor<N>) -> Position<N> {
        Position(N::divide_by(self.0, &k.0))
    }
    /// The tension rounded towards zero to a force.
    #[inline(always)]
    #[must_use]
    pub fn towards_zero(self) -> Force<N> {
        Force(N::round_to_zero(self.0))
    }
    /// The tension rounded towards plus infinity to a force.
    #[inline(always)]
    #[must_use]
    pub fn rounded_up(self) -> Force<N> {
        Force(N::round_up(self.0))
    }
    /// Stretch of a spring of stiffness `k` under this force (tension), rounded towards zero.
    #[inline(always)]
    #[must_use]
    pub fn over(self, k: Stiffness<N>) -> Position<N> {
        Position(N::divide(self.0, k.0))
    }
}
impl<N: Number> Force<N> {
    /// The force converted exactly to a [`Tension`], which has more fractional digits.
    #[inline(always)]
    #[must_use]
    pub fn lift(self) -> Tension<N> {
        Tension(N::lift(self.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Fixed8, Fixed16, Fixed32};

    #[test]
    fn every_signal_comes_back_from_si_to_the_bit() {
        fn both_ways<N: Number>(x: N::Signal)
        where
            N::Signal: Into<Si>,
        {
            let (e, f) = (Position::<N>(x), Force::<N>(x));
            assert_eq!(Position::from_si(e.to_si()), Some(e));
            assert_eq!(Force::from_si(f.to_si()), Some(f));
        }
        for bits in i8::MIN..=i8::MAX {
            both_ways::<Fixed8>(fixed::types::I1F7::from_bits(bits));
        }
        for bits in i16::MIN..=i16::MAX {
            both_ways::<Fixed16>(fixed::types::I2F14::from_bits(bits));
        }
        for bits in [i32::MIN, i32::MIN + 1, -12_345, -1, 0, 1, 12_345, i32::MAX] {
            both_ways::<Fixed32>(fixed::types::I8F24::from_bits(bits));
        }
    }

    #[test]
    fn si_is_rounded_towards_zero_and_refused_outside_the_format() {
        let step = Position::<Fixed32>::quantum();
        let between = step.to_si() + Si::DELTA;
        assert_eq!(Position::<Fixed32>::from_si(between), Some(step));
        assert_eq!(Position::<Fixed32>::from_si(-between), Some(-step));
        assert_eq!(Position::<Fixed32>::from_si(Si::lit("128")), None);
        assert_eq!(Force::<Fixed16>::from_si(Si::lit("2")), None);
        assert!(Force::<Fixed16>::from_si(Si::lit("-2")).is_some());
    }

    #[test]
    fn an_energy_in_si_is_at_most_the_energy() {
        let half = Energy::<Fixed32>::from_si(Si::lit("-0.5")).unwrap();
        assert_eq!(half.to_si(), Si::lit("-0.5"));
        // One step of the energy format is less than a step of SI values. Rounded down, the step is 0, and its negative is minus
        // one step of SI.
        let quantum = Force::<Fixed32>::quantum() * Position::quantum();
        assert_eq!(quantum.to_si(), Si::ZERO);
        assert_eq!((Energy::zero() - quantum).to_si(), -Si::DELTA);
    }
}
