//! Triangles in a tree of boxes. A leaf of the tree holds several triangles that lie side by side: the tree takes 220 bytes a leaf, so that
//! one of single triangles would need most of a mesh's memory.

use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use parry3d_f64::query::{PointQuery as _, Ray, RayCast as _};
use parry3d_f64::shape::Triangle;

/// Triangles of a leaf.
const LEAF: usize = 4;
/// Cells along an axis of the grid by which triangles are ordered.
const CELLS: f64 = 1024.0;

/// Triangles, all of whose corners are finite.
#[derive(Debug, Clone)]
pub(crate) struct Tree {
    boxes: Bvh,
    around: Aabb,
    vertices: Vec<Vector>,
    triangles: Vec<[u32; 3]>,
}

impl Tree {
    /// Of vertices and triangles of their numbers; `None` without a triangle. Every number must be that of a vertex.
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
        let leaves = triangles.chunks(LEAF).map(around_all).enumerate();
        let boxes = Bvh::from_iter(BvhBuildStrategy::Binned, leaves);
        Some(Self {
            boxes,
            around,
            vertices,
            triangles,
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

    fn places(&self, triangle: &[u32; 3]) -> [Vector; 3] {
        triangle.map(|index| self.vertices[index as usize])
    }

    fn leaf(&self, number: u32) -> impl Iterator<Item = [Vector; 3]> {
        let begin = LEAF * number as usize;
        let end = (begin + LEAF).min(self.triangles.len());
        self.triangles[begin..end]
            .iter()
            .map(|triangle| self.places(triangle))
    }

    /// The corners of each triangle whose own box meets another one.
    pub fn near<'a>(&'a self, other: &'a Aabb) -> impl Iterator<Item = [Vector; 3]> + 'a {
        let meets = |[a, b, c]: &[Vector; 3]| {
            let (least, most) = (a.min(*b).min(*c), a.max(*b).max(*c));
            least.cmple(other.maxs).all() && most.cmpge(other.mins).all()
        };
        self.boxes
            .intersect_aabb(other)
            .flat_map(|number| self.leaf(number))
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
