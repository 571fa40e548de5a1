//! A triangle mesh: its triangles with their planes, in a tree of bounding boxes.

use crate::stl;
use parry3d_f64::math::Vector;
use parry3d_f64::shape::TriMesh;
use std::path::Path;
use touchstone_sim::error::{Error, Result};

/// Why triangles make no mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum MeshError {
    /// No triangle has an area.
    NoArea,
    /// A triangle uses a vertex number that does not exist, or a vertex that is not finite.
    Vertex {
        /// Number of the triangle, from 0.
        triangle: usize,
    },
}

impl std::fmt::Display for MeshError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoArea => f.write_str("no triangle has an area"),
            Self::Vertex { triangle } => {
                write!(f, "triangle {triangle} has a vertex that is no number")
            }
        }
    }
}

impl std::error::Error for MeshError {}

/// A triangle with its normal and the directions of its edges, as a proxy needs them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Face {
    /// The corners, counter-clockwise from outside, m.
    pub corners: [Vector; 3],
    /// Normal of length 1 that points outwards.
    pub normal: Vector,
    /// For each edge the direction of length 1 in the triangle's plane, across the edge and into the triangle.
    pub inwards: [Vector; 3],
}

/// A triangle mesh. The side of a triangle from which its corners run counter-clockwise is outside. The mesh need not be closed.
#[derive(Debug, Clone)]
pub struct Mesh {
    pub(crate) tree: TriMesh,
    pub(crate) faces: Vec<Face>,
    size_m: f64,
    left_out: usize,
    solids: usize,
}

impl Mesh {
    /// A mesh of vertices in metres and triangles of vertex numbers. Triangles without an area are left out.
    ///
    /// # Errors
    /// No triangle is left, or a triangle uses a vertex that does not exist.
    pub fn new(
        vertices: &[Vector],
        triangles: &[[u32; 3]],
    ) -> std::result::Result<Self, MeshError> {
        let (mut faces, mut kept) = (Vec::new(), Vec::new());
        for (number, triangle) in triangles.iter().enumerate() {
            let mut corners = [Vector::ZERO; 3];
            for (corner, &index) in corners.iter_mut().zip(triangle) {
                *corner = vertices
                    .get(index as usize)
                    .copied()
                    .filter(|vertex| vertex.is_finite())
                    .ok_or(MeshError::Vertex { triangle: number })?;
            }
            if let Some(face) = Face::new(corners) {
                faces.push(face);
                kept.push(*triangle);
            }
        }
        let left_out = triangles.len() - faces.len();
        let tree = TriMesh::new(vertices.to_vec(), kept).map_err(|_| MeshError::NoArea)?;
        let size_m = tree.local_aabb().extents().length();
        Ok(Self {
            tree,
            faces,
            size_m,
            left_out,
            solids: 1,
        })
    }

    /// Reads a mesh from an STL file, text or binary. STL has no unit: `unit_m` is the file's unit in metres, e.g. 0.001 for
    /// millimetres.
    ///
    /// # Errors
    /// The file cannot be read or is too long, is no STL, or holds no triangle with an area.
    pub fn read_stl(path: &Path, unit_m: f64) -> Result<Self> {
        let bytes =
            stl::bytes_of(path).map_err(|(problem, fix)| Self::wrong(path, problem, fix))?;
        Self::parse_stl(&bytes, path, unit_m)
    }

    /// Reads a mesh from the bytes of an STL file. `path` names the file in messages.
    ///
    /// # Errors
    /// Same as [`Mesh::read_stl`].
    pub fn parse_stl(bytes: &[u8], path: &Path, unit_m: f64) -> Result<Self> {
        let stl = stl::parse(bytes).map_err(|problem| {
            Self::wrong(
                path,
                format!("no STL: {problem}"),
                "export the object as STL",
            )
        })?;
        let mesh = Self::new(&stl.vertices_m(unit_m), &stl.triangles);
        let mut mesh = mesh.map_err(|error| {
            let fix = "export the object as a mesh of triangles";
            Self::wrong(path, error.to_string(), fix)
        })?;
        mesh.solids = stl.solids;
        Ok(mesh)
    }

    fn wrong(path: &Path, problem: String, fix: &str) -> Error {
        Error::Io {
            path: path.to_owned(),
            problem,
            fix: fix.to_owned(),
        }
    }

    /// Number of triangles with an area.
    #[must_use]
    pub fn triangles(&self) -> usize {
        self.faces.len()
    }

    /// Number of triangles without an area, which were left out.
    #[must_use]
    pub const fn left_out(&self) -> usize {
        self.left_out
    }

    /// Number of solids that the STL file names.
    #[must_use]
    pub const fn solids(&self) -> usize {
        self.solids
    }

    /// Diagonal of the mesh's bounding box, m.
    #[must_use]
    pub const fn size_m(&self) -> f64 {
        self.size_m
    }
}

impl Face {
    /// A triangle with its normal and edges; `None` if the corners lie on a line, to rounding.
    fn new(corners: [Vector; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let edges = [b - a, c - b, a - c];
        let across = edges[0].cross(edges[1]);
        let longest = edges
            .iter()
            .map(|edge| edge.length_squared())
            .fold(0.0, f64::max);
        // The triangle's height is below 1e-9 of its longest edge, so its normal would be mere rounding.
        if across.length() <= 1e-9 * longest {
            return None;
        }
        let normal = across.normalize();
        Some(Self {
            corners,
            normal,
            inwards: edges.map(|edge| normal.cross(edge).normalize()),
        })
    }

    /// Height of a point above the triangle's plane, m.
    pub fn height(&self, point: Vector) -> f64 {
        self.normal.dot(point - self.corners[0])
    }

    /// Whether the point, projected on the triangle's plane, lies in the triangle or at most `beside_m` outside its edges.
    pub fn is_below(&self, point: Vector, beside_m: f64) -> bool {
        self.corners
            .iter()
            .zip(&self.inwards)
            .all(|(corner, inwards)| inwards.dot(point - *corner) >= -beside_m)
    }
}
