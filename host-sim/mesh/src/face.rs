//! A triangle of a mesh.

use parry3d_f64::math::Vector;

/// A triangle with its normal. The search tree stores normals, but not the directions of edges, which would take as much memory as
/// the tree.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Face {
    /// Corners of the triangle, counter-clockwise from outside, m.
    pub corners: [Vector; 3],
    /// Normal of length 1 that points outwards.
    pub normal: Vector,
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
