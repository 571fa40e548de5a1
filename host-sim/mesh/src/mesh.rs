//! A triangle mesh: triangles with their normals, in a search tree of bounding boxes.

use crate::file::{self, Kind, MOST_TRIANGLES};
use crate::tree::Tree;
use parry3d_f64::math::Vector;
use std::path::Path;
use touchstone_sim::error::{Error, Result};

/// Reason why triangles do not make a mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum MeshError {
    /// No triangle has an area.
    NoArea,
    /// A triangle refers to a vertex that does not exist or whose coordinates are not finite.
    Vertex {
        /// Number of the triangle, from 0.
        triangle: usize,
    },
    /// There are more than [`MOST_TRIANGLES`] triangles.
    TooMany,
}

impl std::fmt::Display for MeshError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoArea => f.write_str("no triangle has an area"),
            Self::Vertex { triangle } => {
                write!(
                    f,
                    "triangle {triangle} has a vertex that is missing or not a number"
                )
            }
            Self::TooMany => write!(f, "more than {MOST_TRIANGLES} triangles"),
        }
    }
}

impl std::error::Error for MeshError {}

/// A triangle with its normal. The search tree stores normals, but not the directions of edges, which would take as much memory as
/// the tree.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Face {
    /// Corners of the triangle, counter-clockwise from outside, m.
    pub corners: [Vector; 3],
    /// Normal of length 1 that points outwards.
    pub normal: Vector,
}

/// A triangle mesh. The outside of a triangle is the side from which its corners run counter-clockwise. The mesh need not be
/// closed.
#[derive(Debug, Clone)]
pub struct Mesh {
    pub(crate) tree: Tree,
    size_m: f64,
    left_out: usize,
    solids: usize,
    not_convex: usize,
}

impl Mesh {
    /// Makes a mesh from vertices in metres and triangles of three vertex numbers each. Triangles without an area are left out.
    ///
    /// # Errors
    /// No triangle is left, a triangle refers to a missing vertex, or there are more than [`MOST_TRIANGLES`].
    pub fn new(
        vertices: &[Vector],
        triangles: &[[u32; 3]],
    ) -> std::result::Result<Self, MeshError> {
        Self::of(vertices.to_vec(), triangles.to_vec())
    }

    fn of(
        vertices: Vec<Vector>,
        mut triangles: Vec<[u32; 3]>,
    ) -> std::result::Result<Self, MeshError> {
        let all = triangles.len();
        if all > MOST_TRIANGLES {
            return Err(MeshError::TooMany);
        }
        let is_vertex = |index: &u32| {
            let vertex = vertices.get(*index as usize);
            vertex.is_some_and(|vertex| vertex.is_finite())
        };
        if let Some(triangle) = triangles.iter().position(|t| !t.iter().all(is_vertex)) {
            return Err(MeshError::Vertex { triangle });
        }
        triangles.retain(|t| Face::new(t.map(|index| vertices[index as usize])).is_some());
        let left_out = all - triangles.len();
        let tree = Tree::new(vertices, triangles).ok_or(MeshError::NoArea)?;
        let size_m = tree.around().extents().length();
        Ok(Self {
            tree,
            size_m,
            left_out,
            solids: 1,
            not_convex: 0,
        })
    }

    /// Reads a mesh from an STL, OBJ or PLY file; the file's extension gives the format, and an unknown extension means STL. None
    /// of these formats has a unit: `unit_m` is the file's unit in metres, e.g. 0.001 for millimetres.
    ///
    /// # Errors
    /// The file cannot be read or is too long, does not have the format of its extension, or holds no triangle with an area.
    pub fn read(path: &Path, unit_m: f64) -> Result<Self> {
        let kind = Kind::of(path);
        let triangles = {
            let bytes = file::bytes_of(path, kind)
                .map_err(|(problem, fix)| Self::wrong(path, problem, &fix))?;
            Self::triangles_of(&bytes, path, kind)?
        };
        Self::of_file(triangles, path, unit_m)
    }

    /// Reads a mesh from the bytes of a file. `path` names the file in messages; its extension gives the format.
    ///
    /// # Errors
    /// Same as [`Mesh::read`].
    pub fn parse(bytes: &[u8], path: &Path, unit_m: f64) -> Result<Self> {
        Self::of_file(
            Self::triangles_of(bytes, path, Kind::of(path))?,
            path,
            unit_m,
        )
    }

    fn triangles_of(bytes: &[u8], path: &Path, kind: Kind) -> Result<file::Triangles> {
        file::parse(bytes, kind).map_err(|refused| {
            let (problem, fix) = refused.said(kind);
            Self::wrong(path, problem, &fix)
        })
    }

    fn of_file(mut read: file::Triangles, path: &Path, unit_m: f64) -> Result<Self> {
        let vertices = read.vertices_m(unit_m);
        read.vertices = Vec::new();
        let mut mesh = Self::of(vertices, read.triangles).map_err(|error| {
            let fix = "export the object as a mesh of triangles";
            Self::wrong(path, error.to_string(), fix)
        })?;
        mesh.solids = read.solids;
        mesh.not_convex = read.not_convex;
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
        self.tree.triangles().len()
    }

    /// Number of triangles without an area, which were left out.
    #[must_use]
    pub const fn left_out(&self) -> usize {
        self.left_out
    }

    /// Number of solids or objects that the mesh's file names; 1 if it names none.
    #[must_use]
    pub const fn solids(&self) -> usize {
        self.solids
    }

    /// Number of faces in the mesh's file that have more than three corners and are not convex.
    #[must_use]
    pub const fn not_convex(&self) -> usize {
        self.not_convex
    }

    /// Diagonal of the mesh's bounding box, m.
    #[must_use]
    pub const fn size_m(&self) -> f64 {
        self.size_m
    }
}

impl Face {
    /// Makes a triangle with its normal; `None` if the corners lie on one line, to rounding.
    pub fn new(corners: [Vector; 3]) -> Option<Self> {
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
        Some(Self {
            corners,
            normal: across.normalize(),
        })
    }

    /// Height of a point above the triangle's plane, m.
    pub fn height(&self, point: Vector) -> f64 {
        self.normal.dot(point - self.corners[0])
    }

    /// Whether the point, projected on the triangle's plane, lies in the triangle or at most `beside_m` outside its edges.
    pub fn is_below(&self, point: Vector, beside_m: f64) -> bool {
        let [a, b, c] = self.corners;
        [(a, b - a), (b, c - b), (c, a - c)]
            .into_iter()
            .all(|(corner, edge)| {
                // `inwards` is as long as the edge, because the normal has length 1. Comparing squares avoids a root.
                let inwards = self.normal.cross(edge);
                let depth = inwards.dot(point - corner);
                depth >= 0.0 || depth * depth <= beside_m * beside_m * edge.length_squared()
            })
    }
}
