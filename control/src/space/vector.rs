//! Vectors of quantities, and directions.

use super::number::{Axes, Spatial};
use crate::{Energy, Force, Position};
use core::ops::{Add, Neg, Sub};

/// Three quantities of the same type, along x, y and z.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Vector<Q>(pub Axes<Q>);

impl<Q: Copy> Vector<Q> {
    /// Applies a function to each component.
    #[inline(always)]
    pub fn map<R>(self, of: impl FnMut(Q) -> R) -> Vector<R> {
        Vector(self.0.map(of))
    }
    /// Combines two vectors component by component.
    #[inline(always)]
    pub fn zip<P: Copy, R>(self, other: Vector<P>, of: impl Fn(Q, P) -> R) -> Vector<R> {
        let ([a, b, c], [p, q, r]) = (self.0, other.0);
        Vector([of(a, p), of(b, q), of(c, r)])
    }
}

impl<Q: Copy + Add<Output = Q>> Add for Vector<Q> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}
impl<Q: Copy + Sub<Output = Q>> Sub for Vector<Q> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}
impl<Q: Copy + Neg<Output = Q>> Neg for Vector<Q> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

macro_rules! signal_vector {
    ($quantity:ident) => {
        impl<N: Spatial> Vector<$quantity<N>> {
            #[inline(always)]
            pub(super) fn signals(self) -> Axes<N::Signal> {
                self.0.map(|x| x.0)
            }
            /// The vector with opposite sign. Calculated as `0 - v`: a difference takes one instruction on a machine with
            /// saturating sums, a negation four.
            #[inline(always)]
            #[must_use]
            pub(super) fn reversed(self) -> Self {
                self.map(|x| $quantity::zero() - x)
            }
            /// Length of the vector, rounded down: less than one step of the format too short. It saturates.
            #[inline(always)]
            #[must_use]
            pub fn length_down(self) -> $quantity<N> {
                $quantity(N::length_down(self.signals()))
            }
            /// Length of the vector, rounded up: less than one step of the format too long. It saturates.
            #[inline(always)]
            #[must_use]
            pub fn length_up(self) -> $quantity<N> {
                $quantity(N::length_up(self.signals()))
            }
            /// Whether the vector is longer than a limit of at least 0. Exact, and faster than calculating the length.
            #[inline(always)]
            #[must_use]
            pub fn is_longer(self, limit: $quantity<N>) -> bool {
                N::longer(self.signals(), limit.0)
            }
            /// The vector shortened to at most a limit below the end of the number format. A vector within the limit is
            /// unchanged. Each component of a longer vector is less than two steps of the format too short. The direction is
            /// kept, except for the rounding of each component towards zero.
            #[inline]
            #[must_use]
            pub fn within(self, limit: $quantity<N>) -> Self {
                if self.is_longer(limit) {
                    self.shortened(self.length_up(), limit)
                } else {
                    self
                }
            }
            /// [`Vector::within`] for a length that is already known, rounded up.
            #[inline(always)]
            pub(super) fn shortened(self, length: $quantity<N>, limit: $quantity<N>) -> Self {
                if length <= limit {
                    self
                } else {
                    self.cut(length, limit)
                }
            }
            /// Shortens the vector if it is longer than the limit.
            fn cut(self, length: $quantity<N>, limit: $quantity<N>) -> Self {
                // A length at the end of the format may be saturated and thus too small, so the length of half the vector is
                // calculated instead.
                if length + $quantity::<N>::quantum() == length {
                    return self.half_shortened(limit);
                }
                Self(N::shortened(self.signals(), limit.0, length.0).map($quantity))
            }
            #[cold]
            fn half_shortened(self, limit: $quantity<N>) -> Self {
                let (one, two) = (N::QUANTUM, N::add(N::QUANTUM, N::QUANTUM));
                let half = self.map(|x| $quantity::<N>(N::share(x.0, one, two)));
                let length = half.length_up();
                half.map(|x| $quantity(N::share(x.0, limit.0, length.0)))
            }
        }
    };
}
signal_vector!(Position);
signal_vector!(Force);

impl<N: Spatial> Vector<Force<N>> {
    /// Work along a displacement: the exact sum of three exact products. It fits if forces and displacements are at most a quarter
    /// of their format's range, and saturates otherwise.
    #[inline(always)]
    #[must_use]
    pub fn work(self, along: Vector<Position<N>>) -> Energy<N> {
        let [x, y, z] = self.zip(along, |f, d| f * d).0;
        x + y + z
    }
}

/// A unit vector; [`Spatial::unit`] gives its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direction<N: Spatial>(pub Axes<N::Signal>);

impl<N: Spatial> Default for Direction<N> {
    /// The direction straight up, along z.
    fn default() -> Self {
        Self::along(2, false)
    }
}

impl<N: Spatial> Direction<N> {
    /// The direction along a coordinate axis (0 to 2 for x, y, z; larger numbers mean z), or against it.
    #[inline]
    #[must_use]
    pub fn along(axis: usize, against: bool) -> Self {
        let one = if against { N::neg(N::ONE) } else { N::ONE };
        let mut parts = [N::Signal::default(); 3];
        let [x, y, z] = &mut parts;
        *match axis {
            0 => x,
            1 => y,
            _ => z,
        } = one;
        Self(parts)
    }
    /// The direction of a vector; `None` for the zero vector.
    #[inline]
    #[must_use]
    pub fn of(v: Vector<Position<N>>) -> Option<Self> {
        N::unit(v.signals()).map(Self)
    }
    /// The length of a vector, rounded down, and its direction, with a single square root.
    #[inline]
    #[must_use]
    pub fn polar(v: Vector<Position<N>>) -> (Position<N>, Option<Self>) {
        let (length, unit) = N::polar(v.signals());
        (Position(length), unit.map(Self))
    }
    /// The component of a displacement along this direction, rounded down.
    #[inline(always)]
    #[must_use]
    pub fn component(&self, v: Vector<Position<N>>) -> Position<N> {
        Position(N::along(self.0, v.signals()))
    }
    /// The component of a force along this direction, rounded down.
    #[inline(always)]
    #[must_use]
    pub fn component_of_force(&self, v: Vector<Force<N>>) -> Force<N> {
        Force(N::along(self.0, v.signals()))
    }
    /// The cosine of the angle to another direction, rounded down.
    #[inline(always)]
    #[must_use]
    pub fn cosine(&self, other: &Self) -> N::Signal {
        N::along(self.0, other.0)
    }
    /// The vector of this length along the direction: each component rounded towards zero.
    #[inline(always)]
    #[must_use]
    pub fn times(&self, length: Position<N>) -> Vector<Position<N>> {
        Vector(self.0.map(|part| Position(N::times(part, length.0))))
    }
    /// A force of this size along the direction: each component towards zero, so that the force is never longer than `size`.
    #[inline(always)]
    #[must_use]
    pub fn times_force(&self, size: Force<N>) -> Vector<Force<N>> {
        Vector(self.0.map(|part| Force(N::times(part, size.0))))
    }
    /// The part of a displacement perpendicular to the direction. Each component is right within two steps of the format, and the
    /// part is never longer than the displacement.
    #[inline]
    #[must_use]
    pub fn across(&self, v: Vector<Position<N>>) -> Vector<Position<N>> {
        Vector(N::across(self.0, v.signals()).map(Position))
    }
    /// The opposite direction.
    #[inline(always)]
    #[must_use]
    pub fn opposite(&self) -> Self {
        Self(self.0.map(|x| N::sub(N::Signal::default(), x)))
    }
    /// This direction turned towards another by a given angle, right to a few steps of the number format. Unchanged if the two
    /// directions are parallel or opposite.
    #[inline]
    #[must_use]
    pub fn turned(&self, towards: &Self, turn: &Turn<N>) -> Self {
        N::turned(self.0, towards.0, [turn.cosine, turn.sine]).map_or(*self, Self)
    }
}

/// An angle between 0 and 90 degrees, given by its cosine and sine.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn<N: Spatial> {
    /// Cosine of the angle.
    pub cosine: N::Signal,
    /// Sine of the angle.
    pub sine: N::Signal,
}
