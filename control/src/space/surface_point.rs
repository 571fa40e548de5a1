//! The surface point towards which the force is directed. This is the closest surface point, the point of entry, or the closest
//! surface point in a cone (thesis §4.3).

use super::environment::{Nearest, Surface};
use super::number::Spatial;
use super::touch::Touch;
use super::vector::{Direction, Turn, Vector};
use crate::Position;

/// The rule that chooses the surface point towards which the force is directed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Rule<N: Spatial> {
    /// The closest surface point (thesis 4.5). The force's direction can jump as the hand's point (HIP) moves.
    #[default]
    Closest,
    /// The point where the hand's point (HIP) entered the object (thesis 4.6). The HIP is pulled back to that point.
    Penetration,
    /// The closest surface point in a cone around the direction of the last tick (thesis §4.3.3). So the force's direction turns by
    /// at most half the cone's opening angle per tick.
    Restricted(Turn<N>),
}

impl<N: Spatial> Turn<N> {
    /// The turn by half the opening angle of a cone; `across` is the tangent of that half angle.
    #[must_use]
    pub fn of_ratio(across: N::Signal) -> Self {
        let zero = N::Signal::default();
        let [cosine, sine, _] = N::unit([N::ONE, across, zero]).unwrap_or([N::ONE, zero, zero]);
        Self { cosine, sine }
    }
}

/// The rule that chooses the surface point, with its memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint<N: Spatial> {
    /// The rule that chooses the surface point.
    pub rule: Rule<N>,
    /// Outward direction at the closest surface point in the last tick.
    side: Direction<N>,
    /// While the hand's point (HIP) is inside the object: the direction in use, and the point at which the HIP entered. `None`
    /// outside.
    inside: Option<(Direction<N>, Vector<Position<N>>)>,
}

impl<N: Spatial> SurfacePoint<N> {
    /// The state outside the object. An object with two sides, such as a plate, is approached from the side on which the hand's
    /// point (HIP) is first measured.
    #[must_use]
    pub fn new(rule: Rule<N>) -> Self {
        Self {
            rule,
            side: Direction([N::Signal::default(); 3]),
            inside: None,
        }
    }

    /// Runs one control period: takes the position of the hand's point (HIP), returns the contact with the chosen surface point.
    #[inline]
    pub fn tick(&mut self, surface: &impl Surface<N>, at: Vector<Position<N>>) -> Touch<N> {
        let nearest = surface.nearest(at, &self.side);
        self.side = nearest.normal;
        if nearest.depth <= Position::zero() {
            self.inside = None;
            return Touch::measured(at, nearest);
        }
        let (direction, entry) = self
            .inside
            .unwrap_or_else(|| (nearest.normal, at + nearest.normal.times(nearest.depth)));
        let seen = match &self.rule {
            Rule::Closest => nearest,
            Rule::Penetration => back_to(entry, at, nearest),
            Rule::Restricted(turn) => restricted(surface, turn, &direction, &nearest, at),
        };
        self.inside = Some((seen.normal, entry));
        Touch::measured(at, seen)
    }
}

/// The direction from the hand's point (HIP) back to the point where it entered the object.
fn back_to<N: Spatial>(
    entry: Vector<Position<N>>,
    at: Vector<Position<N>>,
    closest: Nearest<N>,
) -> Nearest<N> {
    let (depth, normal) = Direction::polar(entry - at);
    normal.map_or(closest, |normal| Nearest { normal, depth })
}

/// The closest surface point in the cone around a direction.
///
/// From inside, the closest point of a plane within the cone lies along the plane's normal, or on the cone's edge towards that
/// normal. So for an object of planes the result is the shortest way out within the cone. For other objects it is the shorter one
/// of the ways along the cone's axis and towards the closest point.
fn restricted<N: Spatial>(
    surface: &impl Surface<N>,
    turn: &Turn<N>,
    direction: &Direction<N>,
    nearest: &Nearest<N>,
    at: Vector<Position<N>>,
) -> Nearest<N> {
    if Position::<N>(direction.cosine(&nearest.normal)) >= Position(turn.cosine) {
        return *nearest;
    }
    let side = &nearest.normal;
    let mut best: Option<Nearest<N>> = None;
    let mut consider = |normal: Direction<N>| {
        if let Some(depth) = surface.exit(at, &normal, side)
            && best.is_none_or(|best| depth < best.depth)
        {
            best = Some(Nearest { normal, depth });
        }
    };
    let towards_closest = direction.turned(side, turn);
    if surface.is_round() {
        consider(towards_closest);
    } else {
        consider(*direction);
        consider(towards_closest);
        surface.ways(&mut |way: Direction<N>| {
            let inside = Position::<N>(direction.cosine(&way)) >= Position(turn.cosine);
            consider(if inside {
                way
            } else {
                direction.turned(&way, turn)
            });
        });
    }
    // If no direction leads out of the object, the last tick's direction stays until one does.
    best.unwrap_or(Nearest {
        normal: *direction,
        depth: nearest.depth,
    })
}
