//! A triangle mesh: triangles with their normals, in a search tree of bounding boxes.

use crate::face::Face;
use crate::file;
use crate::tree::Tree;
use crate::triangles::{Kind, MOST_TRIANGLES, Triangles};
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

    fn triangles_of(bytes: &[u8], path: &Path, kind: Kind) -> Result<Triangles> {
        file::parse(bytes, kind).map_err(|refused| {
            let (problem, fix) = refused.said(kind);
            Self::wrong(path, problem, &fix)
        })
    }

    fn of_file(mut read: Triangles, path: &Path, unit_m: f64) -> Result<Self> {
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
