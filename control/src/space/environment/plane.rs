//! A half-space: everything below a plane.

use super::{Nearest, Surface, slanted};
use crate::Position;
use crate::space::number::Spatial;
use crate::space::vector::{Direction, Vector};

/// The half-space below a plane. The error of the reported depth is at most one step of the number format; the depth is exact if
/// the normal is a coordinate axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane<N: Spatial> {
    /// The normal of the plane, out of the object.
    pub normal: Direction<N>,
    /// Height of the plane over the origin, along the normal.
    pub height: Position<N>,
}

impl<N: Spatial> Plane<N> {
    /// Height of a point above the plane, negative below.
    #[inline(always)]
    #[must_use]
    pub fn above(&self, at: Vector<Position<N>>) -> Position<N> {
        self.normal.component(at) - self.height
    }
    /// The same plane with the opposite normal.
    #[must_use]
    pub fn flipped(&self) -> Self {
        Self {
            normal: self.normal.opposite(),
            height: -self.height,
        }
    }
}

impl<N: Spatial> Surface<N> for Plane<N> {
    #[inline]
    fn nearest(&self, at: Vector<Position<N>>, _: &Direction<N>) -> Nearest<N> {
        Nearest {
            normal: self.normal,
            depth: -self.above(at),
        }
    }
    fn exit(
        &self,
        at: Vector<Position<N>>,
        along: &Direction<N>,
        _: &Direction<N>,
    ) -> Option<Position<N>> {
        slanted(-self.above(at), self.normal.cosine(along))
    }
    fn ways(&self, visit: &mut dyn FnMut(Direction<N>)) {
        visit(self.normal);
    }
}
