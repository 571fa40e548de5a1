//! Replacement of the crate without the feature `geometry`. No mesh can be made; reading one gives an error that says how to build
//! the program with the feature.

use std::path::Path;
use touchstone_control::space::{Direction, LengthUnit, Nearest, Spatial, Surface, Vector};
use touchstone_control::{Position, Reported};
use touchstone_sim::error::{Error, Result};

/// A triangle mesh. Without the feature `geometry` no value of this type exists.
#[derive(Debug, Clone)]
pub enum Mesh {}

impl Mesh {
    /// Reads nothing and returns an error.
    ///
    /// # Errors
    /// Always: the error says how to build the program with the feature `geometry`.
    pub fn read(path: &Path, _unit_m: f64) -> Result<Self> {
        Err(Error::Io {
            path: path.to_owned(),
            problem: "this program was built without the feature for meshes".to_owned(),
            fix: "build it with `cargo run --release --features mesh`".to_owned(),
        })
    }

    /// Number of triangles with an area.
    #[must_use]
    pub const fn triangles(&self) -> usize {
        match *self {}
    }

    /// Number of triangles without an area, which were left out.
    #[must_use]
    pub const fn left_out(&self) -> usize {
        match *self {}
    }

    /// Diagonal of the mesh's bounding box, m.
    #[must_use]
    pub const fn size_m(&self) -> f64 {
        match *self {}
    }

    /// Remarks on the mesh for the user, one per line. The argument is the box that the device reaches, m.
    #[must_use]
    pub const fn notes(&self, _: [[f64; 3]; 2]) -> Vec<String> {
        match *self {}
    }
}

/// A mesh's surface. Without the feature `geometry` no value of this type exists.
#[derive(Debug, Clone)]
pub struct MeshSurface<'m>(&'m Mesh);

impl<'m> MeshSurface<'m> {
    /// Makes the surface of a mesh. Without the feature `geometry` the function cannot be called, because no mesh exists.
    #[must_use]
    pub const fn new(mesh: &'m Mesh, _: LengthUnit) -> Self {
        Self(mesh)
    }
}

impl<N: Spatial + Reported> Surface<N> for MeshSurface<'_> {
    fn nearest(&self, _: Vector<Position<N>>, _: &Direction<N>) -> Nearest<N> {
        match *self.0 {}
    }

    fn exit(
        &self,
        _: Vector<Position<N>>,
        _: &Direction<N>,
        _: &Direction<N>,
    ) -> Option<Position<N>> {
        match *self.0 {}
    }

    fn ways(&self, _: &mut dyn FnMut(Direction<N>)) {
        match *self.0 {}
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn who_asks_for_a_mesh_hears_how_to_build_the_program() {
        let refused = super::Mesh::read("a.stl".as_ref(), 1e-3).expect_err("no mesh");
        let said = refused.to_string();
        assert!(
            said.contains("a.stl") && said.contains("--features mesh"),
            "{said}"
        );
    }
}
