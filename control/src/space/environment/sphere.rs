//! A ball.

use super::{Nearest, Surface};
use crate::space::number::Spatial;
use crate::space::vector::{Direction, Vector};
use crate::{Energy, Force, Position};

/// A ball. The depth is less than a quantum too large.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere<N: Spatial> {
    /// Centre of the sphere.
    pub centre: Vector<Position<N>>,
    /// Radius of the sphere.
    pub radius: Position<N>,
}

impl<N: Spatial> Surface<N> for Sphere<N> {
    #[inline]
    fn nearest(&self, at: Vector<Position<N>>, side: &Direction<N>) -> Nearest<N> {
        let (length, normal) = Direction::polar(at - self.centre);
        Nearest {
            normal: normal.unwrap_or_else(|| at_centre(side)),
            depth: self.radius - length,
        }
    }
    fn exit(
        &self,
        at: Vector<Position<N>>,
        along: &Direction<N>,
        _: &Direction<N>,
    ) -> Option<Position<N>> {
        Some(chord(self.radius, at - self.centre, along))
    }
    fn ways(&self, _: &mut dyn FnMut(Direction<N>)) {}
    fn is_round(&self) -> bool {
        true
    }
}

/// At the centre all points are as close: the one that was, and up where there was none yet, so that a direction is never without length.
#[cold]
fn at_centre<N: Spatial>(side: &Direction<N>) -> Direction<N> {
    if side.0 == [N::Signal::default(); 3] {
        Direction::default()
    } else {
        *side
    }
}

/// From inside a circle or a ball, at a place seen from its centre: how far it is to the surface in a direction,
/// `sqrt(b² + R² - |v|²) - b` with the part `b` of the place along it.
pub(super) fn chord<N: Spatial>(
    radius: Position<N>,
    from: Vector<Position<N>>,
    direction: &Direction<N>,
) -> Position<N> {
    let along = direction.component(from);
    let square = |a: Position<N>| Force::<N>(a.0) * a;
    // Coordinates are at most a quarter of the format: the sums fit.
    let inside = square(radius) - from.map(|x| Force(x.0)).work(from);
    let sum = square(along) + inside.max(Energy::zero());
    Position(N::root_of_squares(sum.0)) - along
}
