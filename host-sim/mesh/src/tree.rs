//! Triangles in a tree of boxes. The tree takes 220 bytes a leaf. A leaf of an ordinary mesh is one triangle, so that a search is quick. A
//! leaf of a large mesh holds four triangles that lie side by side, so that a million of them fit into memory; a search takes twice as long.

use crate::mesh::Face;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use parry3d_f64::query::{PointQuery as _, Ray, RayCast as _};
use parry3d_f64::shape::Triangle;

/// Triangles of a mesh up to which each has a leaf of its own.
const ORDINARY: usize = 250_000;
/// Triangles of a leaf of a larger mesh.
const LARGE_LEAF: usize = 4;
/// Cells along an axis of the grid by which triangles are ordered.
const CELLS: f64 = 1024.0;

/// Triangles, all of whose corners are finite.
#[derive(Debug, Clone)]
pub(crate) struct Tree {
    boxes: Bvh,
    around: Aabb,
    vertices: Vec<Vector>,
    triangles: Vec<[u32; 3]>,
    /// The normal of each triangle.
    normals: Vec<Vector>,
    /// Triangles of a leaf.
    leaf: usize,
}

impl Tree {
    /// The tree of these triangles, given by numbers of vertices; `None` without a triangle. Every number must be that of a vertex, and
    /// every triangle must have an area.
    pub fn new(vertices: Vec<Vector>, mut triangles: Vec<[u32; 3]>) -> Option<Self> {
        let corner = |index: &u32| vertices[*index as usize];
        let around_all =
            |triangles: &[[u32; 3]]| Aabb::from_points(triangles.iter().flatten().map(corner));
        if triangles.is_empty() {
            return None;
        }
        let around = around_all(&triangles);
        let (least, size) = (around.mins, around.extents());
        triangles.sort_by_cached_key(|triangle| {
            let middle = triangle.iter().map(corner).sum::<Vector>() / 3.0 - least;
            let cell = |axis: usize| {
                let (at, size) = (middle.to_array()[axis], size.to_array()[axis]);
                // 0 / 0 becomes 0.
                (at / size * CELLS).clamp(0.0, CELLS - 1.0) as u32
            };
            interleaved([0, 1, 2].map(cell))
        });
        let normal = |triangle: &[u32; 3]| {
            Face::new([0, 1, 2].map(|at| corner(&triangle[at]))).map(|face| face.normal)
        };
        let normals = triangles.iter().map(normal).collect::<Option<Vec<_>>>()?;
        let leaf = if triangles.len() <= ORDINARY {
            1
        } else {
            LARGE_LEAF
        };
        let leaves = triangles.chunks(leaf).map(around_all).enumerate();
        let boxes = Bvh::from_iter(BvhBuildStrategy::Binned, leaves);
        Some(Self {
            boxes,
            around,
            vertices,
            triangles,
            normals,
            leaf,
        })
    }

    /// The box around all triangles.
    pub const fn around(&self) -> &Aabb {
        &self.around
    }

    /// The vertices, of which triangles may leave some unused.
    pub fn vertices(&self) -> &[Vector] {
        &self.vertices
    }

    /// The triangles, by numbers of vertices.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corners of each triangle.
    pub fn corners(&self) -> impl Iterator<Item = [Vector; 3]> {
        self.triangles.iter().map(|triangle| self.places(triangle))
    }

    #[inline]
    fn places(&self, triangle: &[u32; 3]) -> [Vector; 3] {
        triangle.map(|index| self.vertices[index as usize])
    }

    /// Numbers of the triangles of a leaf.
    #[inline]
    fn numbers(&self, leaf: u32) -> std::ops::Range<usize> {
        let begin = self.leaf * leaf as usize;
        begin..(begin + self.leaf).min(self.triangles.len())
    }

    fn leaf(&self, number: u32) -> impl Iterator<Item = [Vector; 3]> {
        self.triangles[self.numbers(number)]
            .iter()
            .map(|triangle| self.places(triangle))
    }

    /// Each triangle whose own box meets another one.
    #[inline]
    pub fn near<'a>(&'a self, other: &'a Aabb) -> impl Iterator<Item = Face> + 'a {
        let meets = |Face {
                         corners: [a, b, c], ..
                     }: &Face| {
            let (least, most) = (a.min(*b).min(*c), a.max(*b).max(*c));
            least.cmple(other.maxs).all() && most.cmpge(other.mins).all()
        };
        self.boxes
            .intersect_aabb(other)
            .flat_map(|number| self.numbers(number))
            .map(|number| Face {
                corners: self.places(&self.triangles[number]),
                normal: self.normals[number],
            })
            .filter(meets)
    }

    /// Distance from a point to the closest triangle.
    pub fn distance(&self, point: Vector) -> f64 {
        let closest = self.boxes.find_best(
            f64::MAX,
            |node, _| node.aabb().distance_to_local_point(point, true),
            |number, _| {
                self.leaf(number)
                    .map(|[a, b, c]| Triangle::new(a, b, c).project_local_point(point, false))
                    .map(|found| (found.point - point).length())
                    .reduce(f64::min)
                    .map(|distance| (distance, ()))
            },
        );
        closest.map_or(0.0, |(_, (distance, ()))| distance)
    }

    /// Share of a ray, up to `most`, after which it meets the first triangle.
    pub fn hit(&self, ray: &Ray, most: f64) -> Option<f64> {
        let first = self.boxes.cast_ray(ray, most, |number, most| {
            self.leaf(number)
                .filter_map(|[a, b, c]| Triangle::new(a, b, c).cast_local_ray(ray, most, false))
                .reduce(f64::min)
        });
        first.map(|(_, share)| share)
    }
}

/// The bits of three numbers below 1024 in turn, so that what is close in space is close in order.
fn interleaved(cell: [u32; 3]) -> u32 {
    (0..10).fold(0, |sum, bit| {
        let bits = cell.map(|number| number >> bit & 1);
        sum | (bits[0] | bits[1] << 1 | bits[2] << 2) << (3 * bit)
    })
}
