//! Virtual objects. Each gives its closest surface point, and the distance to its surface along a direction.
//!
//! Each request passes the outward direction to the surface point of the last tick. If several points are equally close (at the
//! centre of a sphere, on the diagonal of a box), that direction decides. It also says from which side of a thin plate the hand's
//! point (HIP) came. Distances have errors of a few steps of the number format; each object's documentation gives its error.
//! Lengths are in the device's [unit](super::LengthUnit), and coordinates are at most a quarter of the format's range.

mod cuboid;
mod cylinder;
mod facets;
mod plane;
mod plate;
mod sphere;
mod wedge;

pub use cuboid::Cuboid;
pub use cylinder::Cylinder;
pub use facets::Facets;
pub use plane::Plane;
pub use plate::Plate;
pub use sphere::Sphere;
pub use wedge::{Corner, Edge};

use super::number::Spatial;
use super::vector::{Direction, Vector};
use crate::Position;

/// Direction and depth of the surface point that is closest to the hand's point (HIP).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest<N: Spatial> {
    /// The direction out of the object.
    pub normal: Direction<N>,
    /// Depth of the hand's point (HIP) below the surface point, positive inside.
    pub depth: Position<N>,
}

/// The surface of a virtual object.
pub trait Surface<N: Spatial> {
    /// The surface point closest to the position `at`. `side` is the outward direction of the last tick.
    fn nearest(&self, at: Vector<Position<N>>, side: &Direction<N>) -> Nearest<N>;

    /// Distance from a point inside to the surface along a direction; `None` if that direction does not lead out of the object.
    fn exit(
        &self,
        at: Vector<Position<N>>,
        along: &Direction<N>,
        side: &Direction<N>,
    ) -> Option<Position<N>>;

    /// Calls `visit` with each fixed direction in which the closest surface point can lie, such as a face's normal. The direction
    /// of the closest point may be left out, because the caller tries it anyway.
    fn ways(&self, visit: &mut dyn FnMut(Direction<N>));

    /// Whether from any point inside the way out becomes shorter, the nearer its direction is to that of the closest surface
    /// point. Then only the direction to the closest point needs to be tried.
    fn is_round(&self) -> bool {
        false
    }
}

/// Distance to a plane along a slanted direction, `length / cosine`, from the distance `length` along the plane's normal; `None`
/// if the direction does not lead out.
fn slanted<N: Spatial>(length: Position<N>, cosine: N::Signal) -> Option<Position<N>> {
    (Position::<N>(cosine) > Position::zero()).then(|| Position(N::share(length.0, N::ONE, cosine)))
}

/// A virtual object whose shape is chosen at run time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape<N: Spatial> {
    /// A half-space: everything below a plane.
    Plane(Plane<N>),
    /// A ball.
    Sphere(Sphere<N>),
    /// A box with faces perpendicular to the coordinate axes.
    Cuboid(Cuboid<N>),
    /// A cylinder along a coordinate axis.
    Cylinder(Cylinder<N>),
    /// A thin plate that keeps the hand's point on the side from which the point came.
    Plate(Plate<N>),
    /// A convex edge: the body that lies below both of two planes.
    Edge(Edge<N>),
    /// A concave corner: the body that lies below at least one of two planes.
    Corner(Corner<N>),
}

macro_rules! of_each {
    ($shape:expr, $object:ident => $does:expr) => {
        match $shape {
            Shape::Plane($object) => $does,
            Shape::Sphere($object) => $does,
            Shape::Cuboid($object) => $does,
            Shape::Cylinder($object) => $does,
            Shape::Plate($object) => $does,
            Shape::Edge($object) => $does,
            Shape::Corner($object) => $does,
        }
    };
}

impl<N: Spatial> Surface<N> for Shape<N> {
    #[inline]
    fn nearest(&self, at: Vector<Position<N>>, side: &Direction<N>) -> Nearest<N> {
        of_each!(self, object => object.nearest(at, side))
    }
    fn exit(
        &self,
        at: Vector<Position<N>>,
        along: &Direction<N>,
        side: &Direction<N>,
    ) -> Option<Position<N>> {
        of_each!(self, object => object.exit(at, along, side))
    }
    fn ways(&self, visit: &mut dyn FnMut(Direction<N>)) {
        of_each!(self, object => object.ways(visit))
    }
    fn is_round(&self) -> bool {
        of_each!(self, object => Surface::<N>::is_round(object))
    }
}
