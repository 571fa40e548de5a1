//! Moves a haptic interface point (HIP, the position of the hand) along straight lines through a virtual object, and records the
//! point on the surface that the force points to.

use touchstone_control::Position;
use touchstone_control::space::environment::{Cuboid, Plane, Plate};
use touchstone_control::space::{Direction, Rule, Surface, SurfacePoint, Touch, Turn};

use crate::space::{F, angle, at, mm, numbers};

/// Tangent of the half angle, about one degree, of the cone that limits how fast the surface point may turn.
pub const RATIO: f64 = 0.02;
/// Rounding error of a unit vector, and of the angle between two unit vectors, rad.
pub const ROUNDING: f64 = 1e-6;

/// The rule by which the surface point of a contact turns only within a cone, with the half angle of [`RATIO`].
#[must_use]
pub fn restricted() -> Rule<F> {
    // The ratio is given as a position in centimetres, so that 1 corresponds to 10 mm.
    Rule::Restricted(Turn::of_ratio(mm(10.0 * RATIO).0))
}

/// A plane with this normal, at `height` mm from the origin.
#[must_use]
pub fn plane(normal: Direction<F>, height: f64) -> Plane<F> {
    Plane {
        normal,
        height: mm(height),
    }
}

/// Moves the HIP (hand's position) along straight lines between points in mm, with `ticks` steps per line. Returns the contact with
/// the surface at each step.
#[must_use]
pub fn along(
    rule: Rule<F>,
    surface: &impl Surface<F>,
    corners: &[[f64; 3]],
    ticks: u32,
) -> Vec<Touch<F>> {
    let mut point = SurfacePoint::new(rule);
    let mut touches = Vec::new();
    for leg in corners.windows(2) {
        for tick in 0..=ticks {
            let share = f64::from(tick) / f64::from(ticks);
            let here: [f64; 3] =
                std::array::from_fn(|i| leg[0][i] + share * (leg[1][i] - leg[0][i]));
            touches.push(point.tick(surface, at(here[0], here[1], here[2])));
        }
    }
    touches
}

/// Whether the HIP (hand's position) is inside the object at this contact.
#[must_use]
pub fn inside(touch: &Touch<F>) -> bool {
    touch.depth > Position::zero()
}

/// Largest angle in rad by which the surface's direction turns in one step while the HIP (hand's position) is inside the object.
#[must_use]
pub fn largest_turn(touches: &[Touch<F>]) -> f64 {
    touches
        .windows(2)
        .filter(|pair| pair.iter().all(inside))
        .map(|pair| angle(numbers(&pair[0].normal), numbers(&pair[1].normal)))
        .fold(0.0, f64::max)
}

/// A plate of 0.2 mm. It is thinner than the 0.48 mm that a force of 12 N presses into a virtual wall of 25 N/mm.
#[must_use]
pub fn thin() -> Plate<F> {
    Plate {
        body: Cuboid {
            centre: at(0.0, 0.0, 0.0),
            half: at(30.0, 30.0, 0.1),
        },
        axis: 2,
    }
}
