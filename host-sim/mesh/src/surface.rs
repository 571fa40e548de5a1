//! Makes a mesh with its proxy (surface point) an object for a wall of the control crate.

use crate::mesh::Mesh;
use crate::proxy::Proxy;
use parry3d_f64::math::Vector as Place;
use parry3d_f64::query::Ray;
use std::cell::Cell;
use touchstone_control::space::{Direction, LengthUnit, Nearest, Spatial, Surface, Vector};
use touchstone_control::{Position, Reported};

/// A mesh as an object of a [`touchstone_control::space::SpaceWall`]. The wall pushes towards the surface point, which is the
/// mesh's proxy and keeps its position from tick to tick (control periods). Lengths are in the control law's unit.
#[derive(Debug, Clone)]
pub struct MeshSurface<'m> {
    mesh: &'m Mesh,
    metre: f64,
    /// The proxy. It is in a `Cell` because the wall uses its object through a shared reference, while the proxy changes in every
    /// tick.
    proxy: Cell<Option<Proxy>>,
}

impl<'m> MeshSurface<'m> {
    /// Makes an object without a proxy; the first position of the hand creates the proxy.
    #[must_use]
    pub fn new(mesh: &'m Mesh, unit: LengthUnit) -> Self {
        Self {
            mesh,
            metre: f64::from(unit.per_metre()),
            proxy: Cell::new(None),
        }
    }

    /// Position of the proxy, m; `None` before the first tick.
    #[must_use]
    pub fn proxy_m(&self) -> Option<[f64; 3]> {
        self.proxy.get().map(|proxy| proxy.at().to_array())
    }

    fn place<N: Spatial + Reported>(&self, at: Vector<Position<N>>) -> Place {
        Place::from_array(at.0.map(|x| N::signal_to_f64(x.0) / self.metre))
    }

    fn length<N: Spatial + Reported>(&self, metres: f64) -> Position<N> {
        Position(N::signal_from_f64(metres * self.metre))
    }
}

/// Converts a direction to the control law's number format. It is first scaled to a length that the format holds with all digits,
/// then normalised in the format.
fn direction<N: Spatial + Reported>(way: Place) -> Option<Direction<N>> {
    let largest = way.abs().max_element();
    (largest > 0.0).then_some(())?;
    let parts = (way / largest).to_array();
    Direction::of(Vector(parts.map(|part| Position(N::signal_from_f64(part)))))
}

impl<N: Spatial + Reported> Surface<N> for MeshSurface<'_> {
    fn nearest(&self, at: Vector<Position<N>>, side: &Direction<N>) -> Nearest<N> {
        let hand = self.place(at);
        let mut proxy = self
            .proxy
            .get()
            .unwrap_or_else(|| Proxy::new(self.mesh, hand));
        let point = proxy.follow(self.mesh, hand);
        self.proxy.set(Some(proxy));
        let way = point - hand;
        let depth = way.length();
        // Nothing is in the way, so the hand is outside: the depth is minus the distance from the surface.
        if depth == 0.0 {
            return Nearest {
                normal: *side,
                depth: -self.length::<N>(proxy.clearance(self.mesh)),
            };
        }
        Nearest {
            normal: direction(way).unwrap_or(*side),
            depth: self.length(depth),
        }
    }

    fn exit(
        &self,
        at: Vector<Position<N>>,
        along: &Direction<N>,
        _: &Direction<N>,
    ) -> Option<Position<N>> {
        let way = Place::from_array(along.0.map(N::signal_to_f64));
        let ray = Ray::new(self.place(at), way);
        self.mesh
            .tree
            .hit(&ray, self.mesh.size_m())
            .map(|share| self.length(share * way.length()))
    }

    fn ways(&self, _: &mut dyn FnMut(Direction<N>)) {}
}
