//! A virtual object: a ball.

use super::{Nearest, Surface};
use crate::space::number::Spatial;
use crate::space::vector::{Direction, Vector};
use crate::{Energy, Force, Position};

/// A ball. The reported depth of the hand's point is too large by less than one step of the number format.
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

/// The outward direction for a point at the ball's centre, where all surface points are equally close: that of the last tick, or
/// along z if there was none.
#[cold]
fn at_centre<N: Spatial>(side: &Direction<N>) -> Direction<N> {
    if side.0 == [N::Signal::default(); 3] {
        Direction::default()
    } else {
        *side
    }
}

/// Distance from a point inside a circle or ball to its surface along a direction. `from` is the vector `v` from the centre to the
/// point. For the radius `R` the distance is `sqrt(b² + R² - |v|²) - b`, where `b` is the component of `v` along the direction.
pub(super) fn chord<N: Spatial>(
    radius: Position<N>,
    from: Vector<Position<N>>,
    direction: &Direction<N>,
) -> Position<N> {
    let along = direction.component(from);
    let square = |a: Position<N>| Force::<N>(a.0) * a;
    // Coordinates are at most a quarter of the format's range, so the sums fit.
    let inside = square(radius) - from.map(|x| Force(x.0)).work(from);
    let sum = square(along) + inside.max(Energy::zero());
    Position(N::root_of_squares(sum.0)) - along
}
