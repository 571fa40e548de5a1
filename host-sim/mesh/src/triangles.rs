//! The triangles that a mesh file of any format (STL, OBJ, PLY) gives, or why it gives none.

use parry3d_f64::math::Vector;
use std::collections::HashMap;
use std::ffi::OsStr;
use std::path::Path;

/// Largest number of triangles of a mesh. With its search tree such a mesh takes about 250 MB.
pub const MOST_TRIANGLES: usize = 1_000_000;
/// Largest number of vertices in a file: three per triangle, the number that triangles without shared vertices need.
pub(crate) const MOST_VERTICES: usize = 3 * MOST_TRIANGLES;

/// Format of a mesh file, by the extension of its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Stl,
    Obj,
    Ply,
}

impl Kind {
    /// Format of a file by the extension of its name; STL for any unknown extension.
    pub fn of(path: &Path) -> Self {
        let is = |ending: &str| {
            path.extension()
                .is_some_and(|own: &OsStr| own.eq_ignore_ascii_case(ending))
        };
        match (is("obj"), is("ply")) {
            (true, _) => Self::Obj,
            (_, true) => Self::Ply,
            _ => Self::Stl,
        }
    }

    pub fn name(self) -> &'static str {
        match self {
            Self::Stl => "STL",
            Self::Obj => "OBJ",
            Self::Ply => "PLY",
        }
    }
}

/// Reason why a file gives no mesh.
#[derive(Debug)]
pub(crate) enum Refused {
    /// The content does not have the form of its format; the text says where.
    Form(String),
    /// The file states that it contains this number of triangles, which is too large.
    TooMany { triangles: u64 },
    /// The file contains more triangles or vertices than are read; their number is not known.
    MoreThanRead,
}

impl From<String> for Refused {
    fn from(problem: String) -> Self {
        Self::Form(problem)
    }
}

impl Refused {
    /// Problem and remedy, as text for an error message.
    pub fn said(self, kind: Kind) -> (String, String) {
        let fewer = "export the object with fewer triangles".to_owned();
        match self {
            Self::Form(problem) => (
                format!("no {}: {problem}", kind.name()),
                format!("export the object as {}", kind.name()),
            ),
            Self::TooMany { triangles } => (
                format!("it has {triangles} triangles; at most {MOST_TRIANGLES} are possible"),
                fewer,
            ),
            Self::MoreThanRead => (
                format!(
                    "has more than {MOST_TRIANGLES} triangles or {MOST_VERTICES} vertices, which is the limit"
                ),
                fewer,
            ),
        }
    }
}

/// Vertices and triangles read from a file.
#[derive(Debug, Clone, Default)]
pub(crate) struct Triangles {
    pub vertices: Vec<[f32; 3]>,
    pub triangles: Vec<[u32; 3]>,
    /// Number of solids or objects that the file names; 1 if it names none.
    pub solids: usize,
    /// Number of faces with more than three corners that are not convex. The triangles made from such a face overlap.
    pub not_convex: usize,
}

impl Triangles {
    /// Vertices of the file, converted to metres. `unit_m` is the unit of the file in metres.
    pub fn vertices_m(&self, unit_m: f64) -> Vec<Vector> {
        self.vertices
            .iter()
            .map(|at| unit_m * Vector::from_array(at.map(f64::from)))
            .collect()
    }
}

/// Triangles that repeat the coordinates of their corners, as in STL. Equal coordinates become one vertex.
#[derive(Debug, Default)]
pub(crate) struct Welded {
    found: Triangles,
    known: HashMap<[u32; 3], u32>,
}

impl Welded {
    fn vertex(&mut self, at: [f32; 3]) -> u32 {
        // The coordinates -0 and 0 count as equal.
        let key = at.map(|value| (value + 0.0).to_bits());
        let next = self.found.vertices.len() as u32;
        let number = *self.known.entry(key).or_insert(next);
        if number == next {
            self.found.vertices.push(at);
        }
        number
    }

    pub fn triangle(&mut self, corners: [[f32; 3]; 3]) {
        let numbers = corners.map(|corner| self.vertex(corner));
        self.found.triangles.push(numbers);
    }

    /// Number of triangles added so far.
    pub fn len(&self) -> usize {
        self.found.triangles.len()
    }

    pub fn finish(self, solids: usize) -> Triangles {
        Triangles {
            solids,
            ..self.found
        }
    }
}

/// Faces with any number of corners, as in OBJ and PLY. Corners are given by vertex numbers; the vertices may come later in the
/// file.
#[derive(Debug, Default)]
pub(crate) struct Faces {
    triangles: Vec<[u32; 3]>,
    /// Faces with more than three corners: number of the face's first triangle, and how many triangles the face was divided into.
    fans: Vec<(u32, u32)>,
}

impl Faces {
    /// Adds a face, divided into triangles from its first corner to each edge that does not touch this corner. `place` names the
    /// face in errors.
    ///
    /// # Errors
    /// The face has fewer than three corners, or there are too many triangles.
    pub fn face(&mut self, corners: &[u32], place: impl Fn() -> String) -> Result<(), Refused> {
        let &[first, ref others @ ..] = corners else {
            return Err(format!("{}: a face without a corner", place()).into());
        };
        if others.len() < 2 {
            return Err(format!("{}: a face of {} corners", place(), corners.len()).into());
        }
        if self.triangles.len() + others.len() - 1 > MOST_TRIANGLES {
            return Err(Refused::MoreThanRead);
        }
        if others.len() > 2 {
            let begin = self.triangles.len() as u32;
            self.fans.push((begin, others.len() as u32 - 1));
        }
        let pairs = others.windows(2).map(|pair| [first, pair[0], pair[1]]);
        self.triangles.extend(pairs);
        Ok(())
    }

    /// Combines the faces with the vertices of the whole file.
    ///
    /// # Errors
    /// There is no face.
    pub fn finish(self, vertices: Vec<[f32; 3]>, solids: usize) -> Result<Triangles, Refused> {
        if self.triangles.is_empty() {
            return Err("it contains no face".to_owned().into());
        }
        let across = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|at| {
                let at = vertices.get(at as usize).copied().unwrap_or_default();
                Vector::from_array(at.map(f64::from))
            });
            (b - a).cross(c - a)
        };
        let is_convex = |&&(begin, count): &&(u32, u32)| {
            let fan = &self.triangles[begin as usize..(begin + count) as usize];
            let whole: Vector = fan.iter().map(across).sum();
            fan.iter()
                .all(|triangle| across(triangle).dot(whole) >= 0.0)
        };
        let not_convex = self.fans.len() - self.fans.iter().filter(is_convex).count();
        Ok(Triangles {
            vertices,
            triangles: self.triangles,
            solids: solids.max(1),
            not_convex,
        })
    }
}
