//! Leads a HIP along straight lines through an object, and records the path of its surface point.

use touchstone_control::Position;
use touchstone_control::space::environment::{Cuboid, Plane, Plate};
use touchstone_control::space::{Direction, Rule, Surface, SurfacePoint, Touch, Turn};

use crate::space::{F, angle, at, mm, numbers};

/// Tangent of the cone's half angle, which is about one degree.
pub const RATIO: f64 = 0.02;
/// Rounding error of a direction and of the angle between two directions, rad.
pub const ROUNDING: f64 = 1e-6;

/// The rule "restricted surface point", with the cone of [`RATIO`].
#[must_use]
pub fn restricted() -> Rule<F> {
    // As a position in centimetres, the number 1 is 10 mm.
    Rule::Restricted(Turn::of_ratio(mm(10.0 * RATIO).0))
}

/// A plane with a normal and a height in mm.
#[must_use]
pub fn plane(normal: Direction<F>, height: f64) -> Plane<F> {
    Plane {
        normal,
        height: mm(height),
    }
}

/// All touches along a path of straight lines between points in mm, with this many ticks per line.
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

/// Whether the HIP of a touch is inside the object.
#[must_use]
pub fn inside(touch: &Touch<F>) -> bool {
    touch.depth > Position::zero()
}

/// Largest angle by which the surface direction turns in a tick while the HIP is inside, rad.
#[must_use]
pub fn largest_turn(touches: &[Touch<F>]) -> f64 {
    touches
        .windows(2)
        .filter(|pair| pair.iter().all(inside))
        .map(|pair| angle(numbers(&pair[0].normal), numbers(&pair[1].normal)))
        .fold(0.0, f64::max)
}

/// A plate of 0.2 mm, thinner than the 0.48 mm by which 12 N press into a wall of 25 N/mm.
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
