//! Objects of two planes: an edge, which lies below both planes, and a corner, which lies below at least one.

use super::{Nearest, Plane, Surface, slanted};
use crate::Position;
use crate::space::number::Spatial;
use crate::space::vector::{Direction, Vector};

/// A convex edge: the body that lies below both of two planes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge<N: Spatial> {
    planes: [Plane<N>; 2],
    /// Cosine of the angle between the two planes' normals (their scalar product).
    cosine: N::Signal,
    /// Square of the sine of the angle between the two planes' normals.
    sine_squared: N::Signal,
}

impl<N: Spatial> Edge<N> {
    /// The edge of two planes. The error of depths around the edge is a few steps of the number format, divided by the square of
    /// the sine of the angle between the normals.
    #[must_use]
    pub fn new(planes: [Plane<N>; 2]) -> Self {
        let [one, other] = &planes;
        let cosine = one.normal.cosine(&other.normal);
        Self {
            planes,
            cosine,
            sine_squared: N::sub(N::ONE, N::times(cosine, cosine)),
        }
    }

    /// The height over one plane after a displacement `way` towards the other plane. `height` is the height before that
    /// displacement.
    fn beyond(&self, height: Position<N>, way: Position<N>) -> Position<N> {
        height - Position(N::times(self.cosine, way.0))
    }
}

impl<N: Spatial> Surface<N> for Edge<N> {
    fn nearest(&self, at: Vector<Position<N>>, _: &Direction<N>) -> Nearest<N> {
        let [one, other] = &self.planes;
        let (first, second) = (one.above(at), other.above(at));
        let zero = Position::zero();
        let of = |plane: &Plane<N>, above: Position<N>| Nearest {
            normal: plane.normal,
            depth: -above,
        };
        let inside = first <= zero && second <= zero;
        let higher = if second > first {
            of(other, second)
        } else {
            of(one, first)
        };
        if inside {
            return higher;
        }
        if first > zero && self.beyond(second, first) <= zero {
            return of(one, first);
        }
        if second > zero && self.beyond(first, second) <= zero {
            return of(other, second);
        }
        // The edge itself is closest. The vector from the edge to the point is perpendicular to the edge and has the heights
        // `first` and `second` over the two planes.
        let part = |height, way| {
            Position(N::share(
                self.beyond(height, way).0,
                N::ONE,
                self.sine_squared,
            ))
        };
        let across =
            one.normal.times(part(first, second)) + other.normal.times(part(second, first));
        Direction::of(across).map_or(higher, |normal| Nearest {
            normal,
            depth: -across.length_down(),
        })
    }
    fn exit(
        &self,
        at: Vector<Position<N>>,
        along: &Direction<N>,
        side: &Direction<N>,
    ) -> Option<Position<N>> {
        let [one, other] = &self.planes;
        match (one.exit(at, along, side), other.exit(at, along, side)) {
            (Some(one), Some(other)) => Some(one.min(other)),
            (one, other) => one.or(other),
        }
    }
    fn ways(&self, visit: &mut dyn FnMut(Direction<N>)) {
        self.planes.iter().for_each(|plane| visit(plane.normal));
    }
}

/// A concave corner: the body that lies below at least one of two planes. A hand's point (HIP) that is pressed into the corner
/// stays at the crease, and the force lies in the plane of both normals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Corner<N: Spatial> {
    /// The free space above both planes, treated as an edge: the corner's surface is the edge's, seen from the other side.
    free: Edge<N>,
}

impl<N: Spatial> Corner<N> {
    /// The corner of two planes. Depths have the error that [`Edge::new`] states.
    #[must_use]
    pub fn new(planes: [Plane<N>; 2]) -> Self {
        Self {
            free: Edge::new(planes.map(|plane| plane.flipped())),
        }
    }
}

impl<N: Spatial> Surface<N> for Corner<N> {
    fn nearest(&self, at: Vector<Position<N>>, side: &Direction<N>) -> Nearest<N> {
        let free = self.free.nearest(at, side);
        Nearest {
            normal: free.normal.opposite(),
            depth: -free.depth,
        }
    }
    fn exit(
        &self,
        at: Vector<Position<N>>,
        along: &Direction<N>,
        _: &Direction<N>,
    ) -> Option<Position<N>> {
        // The free space is above both planes, so the longer of the two ways leads there. If the point is above one plane
        // already, it must stay above that plane.
        let mut longest = Position::zero();
        for plane in &self.free.planes {
            let below = plane.above(at);
            if below > Position::zero() {
                longest = longest.max(slanted(below, plane.normal.opposite().cosine(along))?);
            }
        }
        let end = at + along.times(longest);
        let four = (0..4).fold(Position::zero(), |sum, _| sum + Position::quantum());
        let out = self
            .free
            .planes
            .iter()
            .all(|plane| plane.above(end) <= four);
        out.then_some(longest)
    }
    fn ways(&self, visit: &mut dyn FnMut(Direction<N>)) {
        let normals = self.free.planes.iter().map(|plane| plane.normal.opposite());
        normals.for_each(visit);
    }
}
