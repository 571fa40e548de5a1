//! Virtual objects: the closest surface point, and how far it is to the surface along a direction.
//!
//! Every object is asked with the direction in which its surface point lay in the last tick, outwards. It decides where several points are as
//! close (the centre of a sphere, the diagonal of a box), and which side of a thin plate the HIP came from. Distances are right
//! to a few quanta of the format; that of each object is in its documentation. Lengths are in the device's
//! [unit](super::LengthUnit), and coordinates at most a quarter of the format.

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

/// The closest surface point, as seen from the HIP.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nearest<N: Spatial> {
    /// The direction out of the object.
    pub normal: Direction<N>,
    /// How deep the HIP is below it, positive inside.
    pub depth: Position<N>,
}

/// A virtual object.
pub trait Surface<N: Spatial> {
    /// The closest surface point. `side` is the outward direction of the last tick.
    fn nearest(&self, at: Vector<Position<N>>, side: &Direction<N>) -> Nearest<N>;

    /// From inside: how far it is to the surface in a direction; `None` where that leads nowhere out.
    fn exit(
        &self,
        at: Vector<Position<N>>,
        along: &Direction<N>,
        side: &Direction<N>,
    ) -> Option<Position<N>>;

    /// The directions in which surface points can be closest, apart from that of the closest one.
    fn ways(&self, visit: &mut dyn FnMut(Direction<N>));

    /// Whether from everywhere inside the way out is the shorter the nearer it lies to that to the closest point: then the only way
    /// to ask for is the one towards it.
    fn is_round(&self) -> bool {
        false
    }
}

/// `length / cosine`; `None` where the direction does not lead out.
fn slanted<N: Spatial>(length: Position<N>, cosine: N::Signal) -> Option<Position<N>> {
    (Position::<N>(cosine) > Position::zero()).then(|| Position(N::share(length.0, N::ONE, cosine)))
}

/// An object chosen at run time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape<N: Spatial> {
    /// A half-space.
    Plane(Plane<N>),
    /// A ball.
    Sphere(Sphere<N>),
    /// A box along the axes.
    Cuboid(Cuboid<N>),
    /// A cylinder along an axis.
    Cylinder(Cylinder<N>),
    /// A thin plate.
    Plate(Plate<N>),
    /// What lies below two planes.
    Edge(Edge<N>),
    /// What lies below one of two planes or the other.
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
