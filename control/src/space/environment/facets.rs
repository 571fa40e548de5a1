//! A virtual object: a convex body that is bounded by many planes.

use super::{Nearest, Plane, Surface};
use crate::Position;
use crate::space::number::Spatial;
use crate::space::vector::{Direction, Vector};

/// The body that lies below all of its planes. Inside, the error of the depth is at most a step of the number format. Outside,
/// the depth is measured from the plane that the point is furthest above; near an edge the true distance to the body is larger.
/// Planes may coincide, and a plane without a direction is ignored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facets<'a, N: Spatial> {
    /// The planes that bound the body.
    pub planes: &'a [Plane<N>],
}

impl<N: Spatial> Facets<'_, N> {
    fn real(&self) -> impl Iterator<Item = &Plane<N>> {
        let nothing = [N::Signal::default(); 3];
        self.planes
            .iter()
            .filter(move |plane| plane.normal.0 != nothing)
    }
}

impl<N: Spatial> Surface<N> for Facets<'_, N> {
    fn nearest(&self, at: Vector<Position<N>>, side: &Direction<N>) -> Nearest<N> {
        let mut nearest: Option<Nearest<N>> = None;
        for plane in self.real() {
            let here = plane.nearest(at, side);
            // Of equally close planes, the plane of the last tick counts.
            let closer = nearest.is_none_or(|nearest| {
                here.depth < nearest.depth || here.depth == nearest.depth && here.normal == *side
            });
            if closer {
                nearest = Some(here);
            }
        }
        // Without planes there is no object.
        nearest.unwrap_or(Nearest {
            normal: *side,
            depth: -Position::quantum(),
        })
    }
    fn exit(
        &self,
        at: Vector<Position<N>>,
        along: &Direction<N>,
        side: &Direction<N>,
    ) -> Option<Position<N>> {
        self.real()
            .filter_map(|plane| plane.exit(at, along, side))
            .reduce(Position::min)
    }
    fn ways(&self, visit: &mut dyn FnMut(Direction<N>)) {
        self.real().for_each(|plane| visit(plane.normal));
    }
}
