//! The proxy: a point that follows the hand and never goes through a front face.
//!
//! Every tick it goes straight towards the hand. A face in its way stops it, and from there it goes to the point that is closest to the hand
//! and below none of the planes that stopped it: on one plane, on the crease of two, or in the corner of three. That is repeated with
//! no plane in mind until nothing stops it any more, so that it slides over an edge within the tick. So however thin a
//! plate is and however fast the hand, the proxy stays on the side on which it was.
//!
//! Planes are kept at a distance, the [gap](Proxy::gap_m): a ten-millionth of the object, so that rounding puts the proxy
//! behind none of them. Triangles are as much larger at their edges that nothing slips through between two.

use crate::mesh::{Face, Mesh};
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;

/// Times the proxy goes on with no plane in mind.
const ROUNDS: usize = 6;
/// Most planes that may stop the proxy in a round.
const PLANES: usize = 6;
/// How far a triangle reaches beyond its edges, gaps: for edges down to 15 degrees.
const BESIDE_GAPS: f64 = 8.0;

/// A plane that nothing may be below: `normal · x >= least`.
#[derive(Debug, Clone, Copy)]
struct Plane {
    normal: Vector,
    least: f64,
}

/// A point on the outside of a mesh.
#[derive(Debug, Clone, Copy)]
pub struct Proxy {
    at: Vector,
    gap_m: f64,
}

impl Proxy {
    /// Where the hand is first seen.
    #[must_use]
    pub fn new(mesh: &Mesh, at: Vector) -> Self {
        Self {
            at,
            gap_m: 1e-7 * mesh.size_m(),
        }
    }

    /// Where it is, m.
    #[must_use]
    pub const fn at(&self) -> Vector {
        self.at
    }

    /// How far it keeps from every face, m.
    #[must_use]
    pub const fn gap_m(&self) -> f64 {
        self.gap_m
    }

    /// Follows the hand, all in metres; where it comes to. It is the hand's own place where nothing is in the way.
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

    /// Goes towards the hand until no plane stops the proxy, or as many do as there are directions.
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

    /// The first front face on the straight way to a place, of those that have not stopped it yet, and the share of the way until there.
    fn first(&self, mesh: &Mesh, goal: Vector, known: &[Plane]) -> Option<(f64, Face)> {
        let gap = self.gap_m;
        let around = Vector::splat(2.0 * BESIDE_GAPS * gap);
        let way = Aabb::new(self.at.min(goal) - around, self.at.max(goal) + around);
        let mut best: Option<(f64, Face)> = None;
        for face in mesh.tree.near(&way).filter_map(Face::new) {
            let (here, there) = (face.height(self.at), face.height(goal));
            // From above it, or from the slip of rounding, to below where it keeps things.
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

    /// Distance of the hand from the surface when the proxy is with it, m.
    pub(crate) fn clearance(&self, mesh: &Mesh) -> f64 {
        mesh.tree.distance(self.at)
    }
}

/// The point closest to a place that lies below none of the planes: on one, two or three of them.
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
            // `place + u a + v b` on both; where they are parallel, the other plane's own point serves.
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
