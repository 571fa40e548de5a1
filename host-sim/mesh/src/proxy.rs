//! The proxy of a mesh: a point that follows the hand's point, but never passes through a triangle from its outside.
//!
//! In every tick (control period) the proxy moves straight towards the hand. If a triangle on the way stops it, the proxy moves to
//! the point closest to the hand that lies below none of the planes that stopped it. That point is on one plane, on the line where
//! two meet, or in the corner of three. Both steps are repeated, each time without the earlier planes, until nothing stops the
//! proxy. The proxy can therefore slide over an edge within a tick. However thin a plate is and however fast the hand, the proxy
//! stays on its side of the plate.
//!
//! The proxy keeps a distance from planes, the [gap](Proxy::gap_m): a ten-millionth of the object's size, so that rounding never
//! puts it behind a plane. Triangles are enlarged slightly at their edges, so that the proxy cannot slip through between two.

use crate::face::Face;
use crate::mesh::Mesh;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;

/// Largest number of rounds per tick (control period). Each round starts without the planes that stopped the proxy in earlier
/// rounds.
const ROUNDS: usize = 6;
/// Largest number of planes that may stop the proxy in a round.
const PLANES: usize = 6;
/// Distance by which a triangle is enlarged at its edges, as a multiple of the proxy's gap. It suffices for edges at which two
/// triangles enclose an angle of at least 15°.
const BESIDE_GAPS: f64 = 8.0;

/// A plane below which the proxy may not go: `normal · x >= least` for the proxy's position `x`.
#[derive(Debug, Clone, Copy)]
struct Plane {
    normal: Vector,
    least: f64,
}

/// A point on the outside of a mesh that follows the hand.
#[derive(Debug, Clone, Copy)]
pub struct Proxy {
    at: Vector,
    gap_m: f64,
}

impl Proxy {
    /// Makes a proxy at the hand's first position, m.
    #[must_use]
    pub fn new(mesh: &Mesh, at: Vector) -> Self {
        Self {
            at,
            gap_m: 1e-7 * mesh.size_m(),
        }
    }

    /// Position of the proxy, m.
    #[must_use]
    pub const fn at(&self) -> Vector {
        self.at
    }

    /// Distance that the proxy keeps from every triangle, m.
    #[must_use]
    pub const fn gap_m(&self) -> f64 {
        self.gap_m
    }

    /// Moves the proxy towards the hand and returns its new position, m. If nothing is in the way, this is the hand's position.
    pub fn follow(&mut self, mesh: &Mesh, hand: Vector) -> Vector {
        for _ in 0..ROUNDS {
            let before = self.at;
            self.round(mesh, hand);
            if self.at == hand || (self.at - before).length() <= 0.5 * self.gap_m {
                break;
            }
        }
        self.at
    }

    /// Moves the proxy towards the hand until no plane stops it, or until [`PLANES`] planes have.
    fn round(&mut self, mesh: &Mesh, hand: Vector) {
        let mut planes: Vec<Plane> = Vec::with_capacity(PLANES);
        let mut goal = hand;
        while planes.len() < PLANES {
            let Some((share, face)) = self.first(mesh, goal, &planes) else {
                self.at = goal;
                return;
            };
            self.at += share * (goal - self.at);
            planes.push(self.plane(&face));
            goal = closest(hand, &planes, self.gap_m).unwrap_or(self.at);
        }
    }

    fn plane(&self, face: &Face) -> Plane {
        Plane {
            normal: face.normal,
            least: face.normal.dot(face.corners[0]) + self.gap_m,
        }
    }

    /// The first triangle that the proxy meets from its outside on the straight way to `goal`, with the fraction of the way up to
    /// it. Triangles of the planes `known` are ignored.
    fn first(&self, mesh: &Mesh, goal: Vector, known: &[Plane]) -> Option<(f64, Face)> {
        let gap = self.gap_m;
        let around = Vector::splat(2.0 * BESIDE_GAPS * gap);
        let way = Aabb::new(self.at.min(goal) - around, self.at.max(goal) + around);
        let mut best: Option<(f64, Face)> = None;
        for face in mesh.tree.near(&way) {
            let (here, there) = (face.height(self.at), face.height(goal));
            // The proxy can only meet the triangle on a way from above it (or from just below it, by rounding) to closer than the
            // gap.
            if here < -gap || there >= gap * (1.0 - 1e-3) || there >= here {
                continue;
            }
            let share = ((here - gap) / (here - there)).clamp(0.0, 1.0);
            if best.is_some_and(|(least, _)| share >= least) {
                continue;
            }
            let plane = self.plane(&face);
            let again = known
                .iter()
                .any(|known| known.normal == plane.normal && known.least == plane.least);
            if !again && face.is_below(self.at + share * (goal - self.at), BESIDE_GAPS * gap) {
                best = Some((share, face));
            }
        }
        best
    }

    /// Distance of the proxy from the mesh, m. While the proxy is at the hand, this is the hand's distance from the surface.
    pub(crate) fn clearance(&self, mesh: &Mesh) -> f64 {
        mesh.tree.distance(self.at)
    }
}

/// The point closest to `place` that lies below none of the planes: it lies on one, two or three of them. `None` if no such point
/// is above all planes.
fn closest(place: Vector, planes: &[Plane], gap_m: f64) -> Option<Vector> {
    let allowed = |point: &Vector| {
        planes
            .iter()
            .all(|plane| plane.normal.dot(*point) >= plane.least - 1e-4 * gap_m)
    };
    let mut best: Option<(f64, Vector)> = None;
    let mut consider = |point: Vector| {
        let distance = (point - place).length_squared();
        if allowed(&point) && best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, point));
        }
    };
    for (i, a) in planes.iter().enumerate() {
        let missing = |plane: &Plane| plane.least - plane.normal.dot(place);
        consider(place + missing(a) * a.normal);
        for (j, b) in planes.iter().enumerate().skip(i + 1) {
            // The point `place + u a + v b` is on both planes. If they are parallel, the point on one plane alone is used.
            let along = a.normal.dot(b.normal);
            let free = 1.0 - along * along;
            if free > 1e-12 {
                let (p, q) = (missing(a), missing(b));
                let (u, v) = ((p - along * q) / free, (q - along * p) / free);
                consider(place + u * a.normal + v * b.normal);
            }
            for c in planes.iter().skip(j + 1) {
                let volume = a.normal.dot(b.normal.cross(c.normal));
                if volume.abs() > 1e-9 {
                    let sum = a.least * b.normal.cross(c.normal)
                        + b.least * c.normal.cross(a.normal)
                        + c.least * a.normal.cross(b.normal);
                    consider(sum / volume);
                }
            }
        }
    }
    best.map(|(_, point)| point)
}
