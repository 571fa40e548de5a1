//! Meshes for the tests: made by loops, so that nothing has to be read.
#![allow(dead_code)]

use touchstone_mesh::{Mesh, Vector};

/// Millimetres.
pub fn mm(x: f64, y: f64, z: f64) -> Vector {
    1e-3 * Vector::new(x, y, z)
}

/// Vertices and triangles.
#[derive(Default, Clone)]
pub struct Soup {
    pub vertices: Vec<Vector>,
    pub triangles: Vec<[u32; 3]>,
}

impl Soup {
    pub fn mesh(&self) -> Mesh {
        Mesh::new(&self.vertices, &self.triangles).expect("a mesh")
    }

    fn vertex(&mut self, at: Vector) -> u32 {
        self.vertices.push(at);
        self.vertices.len() as u32 - 1
    }

    /// A flat face of four corners, counter-clockwise from outside, with a seam along its diagonal.
    pub fn quad(&mut self, corners: [Vector; 4]) {
        let [a, b, c, d] = corners.map(|corner| self.vertex(corner));
        self.triangles.extend([[a, b, c], [a, c, d]]);
    }

    pub fn triangle(&mut self, corners: [Vector; 3]) {
        let corners = corners.map(|corner| self.vertex(corner));
        self.triangles.push(corners);
    }
}

/// A box around the origin, half sizes in mm.
pub fn block(x: f64, y: f64, z: f64) -> Soup {
    let at = |i: f64, j: f64, k: f64| mm(x * i, y * j, z * k);
    let mut soup = Soup::default();
    soup.quad([
        at(-1., -1., 1.),
        at(1., -1., 1.),
        at(1., 1., 1.),
        at(-1., 1., 1.),
    ]);
    soup.quad([
        at(-1., 1., -1.),
        at(1., 1., -1.),
        at(1., -1., -1.),
        at(-1., -1., -1.),
    ]);
    soup.quad([
        at(1., -1., -1.),
        at(1., 1., -1.),
        at(1., 1., 1.),
        at(1., -1., 1.),
    ]);
    soup.quad([
        at(-1., 1., -1.),
        at(-1., -1., -1.),
        at(-1., -1., 1.),
        at(-1., 1., 1.),
    ]);
    soup.quad([
        at(1., 1., -1.),
        at(-1., 1., -1.),
        at(-1., 1., 1.),
        at(1., 1., 1.),
    ]);
    soup.quad([
        at(-1., -1., -1.),
        at(1., -1., -1.),
        at(1., -1., 1.),
        at(-1., -1., 1.),
    ]);
    soup
}

/// A V of two half-planes with the crease along y through the origin, each rising at this many radians. Open at its
/// ends.
pub fn valley(slope: f64) -> Soup {
    let (x, z) = (30.0 * slope.cos(), 30.0 * slope.sin());
    let mut soup = Soup::default();
    soup.quad([
        mm(0., -30., 0.),
        mm(x, -30., z),
        mm(x, 30., z),
        mm(0., 30., 0.),
    ]);
    soup.quad([
        mm(-x, -30., z),
        mm(0., -30., 0.),
        mm(0., 30., 0.),
        mm(-x, 30., z),
    ]);
    soup
}

/// A pyramid of this many faces, apex at the origin, as high as wide, with its base.
pub fn pyramid(faces: u32) -> Soup {
    let corner = |i: u32| {
        let phi = std::f64::consts::TAU * f64::from(i % faces) / f64::from(faces);
        mm(20.0 * phi.cos(), 20.0 * phi.sin(), -20.0)
    };
    let mut soup = Soup::default();
    for i in 0..faces {
        soup.triangle([Vector::ZERO, corner(i), corner(i + 1)]);
        soup.triangle([mm(0., 0., -20.), corner(i + 1), corner(i)]);
    }
    soup
}

/// A ball of this many rings and twice as many sectors.
pub fn ball(radius_mm: f64, rings: u32) -> Soup {
    let at = |ring: u32, sector: u32| {
        let theta = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
        let phi = std::f64::consts::PI * f64::from(sector) / f64::from(rings);
        radius_mm
            * mm(
                theta.sin() * phi.cos(),
                theta.sin() * phi.sin(),
                theta.cos(),
            )
    };
    let mut soup = Soup::default();
    for ring in 0..rings {
        for sector in 0..2 * rings {
            // Triangles without an area at the poles are left out by the mesh.
            soup.triangle([
                at(ring, sector),
                at(ring + 1, sector),
                at(ring + 1, sector + 1),
            ]);
            soup.triangle([
                at(ring, sector),
                at(ring + 1, sector + 1),
                at(ring, sector + 1),
            ]);
        }
    }
    soup
}

/// A prism along y through a convex outline of x and z in mm, counter-clockwise seen against y; 60 mm long, open at its ends.
pub fn prism(outline: &[[f64; 2]]) -> Soup {
    let mut soup = Soup::default();
    for (i, &[x, z]) in outline.iter().enumerate() {
        let [next_x, next_z] = outline[(i + 1) % outline.len()];
        soup.quad([
            mm(x, -30., z),
            mm(x, 30., z),
            mm(next_x, 30., next_z),
            mm(next_x, -30., next_z),
        ]);
    }
    soup
}
