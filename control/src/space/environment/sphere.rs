//! A ball.

use super::{Nearest, Surface};
use crate::space::number::Spatial;
use crate::space::vector::{Direction, Vector};
use crate::{Energy, Force, Position};

/// A ball. The depth is less than a quantum too large.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere<N: Spatial> {
    /// Its centre.
    pub centre: Vector<Position<N>>,
    /// Its radius.
    pub radius: Position<N>,
}

impl<N: Spatial> Surface<N> for Sphere<N> {
    #[inline]
    fn nearest(&self, at: Vector<Position<N>>, side: &Direction<N>) -> Nearest<N> {
        let from = at - self.centre;
        Nearest {
            // At the centre all points are as close: the one that was.
            normal: Direction::of(from).unwrap_or(*side),
            depth: self.radius - from.length_down(),
        }
    }
    fn exit(
        &self,
        at: Vector<Position<N>>,
        along: &Direction<N>,
        _: &Direction<N>,
    ) -> Option<Position<N>> {
        let from = at - self.centre;
        Some(chord(
            self.radius,
            from.length_down(),
            along.component(from),
        ))
    }
    fn ways(&self, _: &mut dyn FnMut(Direction<N>)) {}
}

/// From inside a circle, at a distance from its centre of which a part lies along the way: how far it is to the circle,
/// `sqrt(b² + (R - r)(R + r)) - b`.
pub(super) fn chord<N: Spatial>(
    radius: Position<N>,
    from: Position<N>,
    along: Position<N>,
) -> Position<N> {
    let square = |a: Position<N>, b: Position<N>| Force::<N>(a.0) * b;
    let sum = square(along, along) + square(radius - from, radius + from).max(Energy::zero());
    Position(N::root(sum.0)) - along
}
