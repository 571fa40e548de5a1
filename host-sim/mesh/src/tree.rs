//! A search tree of bounding boxes over triangles. The tree takes 220 bytes per leaf. A leaf of an ordinary mesh is one triangle,
//! so that a search is fast. A leaf of a large mesh holds four neighbouring triangles, so that a million fit into memory; a search
//! then takes twice as long.

use crate::face::Face;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use parry3d_f64::query::{PointQuery as _, Ray, RayCast as _};
use parry3d_f64::shape::Triangle;

/// Largest number of triangles of a mesh in which each triangle has its own leaf.
const ORDINARY: usize = 250_000;
/// Number of triangles per leaf in a larger mesh.
const LARGE_LEAF: usize = 4;
/// Number of cells along each axis of the grid by which triangles are sorted.
const CELLS: f64 = 1024.0;

/// A search tree over triangles, all of whose corners are finite.
#[derive(Debug, Clone)]
pub(crate) struct Tree {
    boxes: Bvh,
    around: Aabb,
    vertices: Vec<Vector>,
    triangles: Vec<[u32; 3]>,
    /// The normal of each triangle.
    normals: Vec<Vector>,
    /// Number of triangles per leaf.
    leaf: usize,
}

impl Tree {
    /// Builds the tree from triangles of three vertex numbers each; `None` without a triangle. Every vertex number must exist, and
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

    /// Bounding box around all triangles, m.
    pub const fn around(&self) -> &Aabb {
        &self.around
    }

    /// All vertices, m; some may belong to no triangle.
    pub fn vertices(&self) -> &[Vector] {
        &self.vertices
    }

    /// All triangles, as three vertex numbers each.
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

    /// Numbers of the triangles in a leaf.
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

    /// All triangles whose bounding box meets the box `other`.
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

    /// Distance from a point to the closest triangle, m.
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

    /// Fraction of a ray's length, up to `most`, after which the ray meets the first triangle; `None` if it meets none.
    pub fn hit(&self, ray: &Ray, most: f64) -> Option<f64> {
        let first = self.boxes.cast_ray(ray, most, |number, most| {
            self.leaf(number)
                .filter_map(|[a, b, c]| Triangle::new(a, b, c).cast_local_ray(ray, most, false))
                .reduce(f64::min)
        });
        first.map(|(_, share)| share)
    }
}

/// Interleaves the bits of three numbers below 1024 (Morton order), so that neighbours in space are neighbours in order.
fn interleaved(cell: [u32; 3]) -> u32 {
    (0..10).fold(0, |sum, bit| {
        let bits = cell.map(|number| number >> bit & 1);
        sum | (bits[0] | bits[1] << 1 | bits[2] << 2) << (3 * bit)
    })
}
