//! Where the force is directed: closest surface point, point of penetration, restricted surface point (thesis §4.3).

use super::environment::{Nearest, Surface};
use super::number::Spatial;
use super::touch::Touch;
use super::vector::{Direction, Turn, Vector};
use crate::Position;

/// The rule.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Rule<N: Spatial> {
    /// The closest surface point (4.5): the direction can jump (Fig. 4.3).
    #[default]
    Closest,
    /// Where the HIP came in (4.6): it is pulled back there (Fig. 4.4).
    Penetration,
    /// The closest one in a cone around the direction of the last tick (§4.3.3): the direction turns by at most the cone's
    /// angle in a tick (Fig. 4.5).
    Restricted(Turn<N>),
}

impl<N: Spatial> Turn<N> {
    /// A rule with a cone, given by the tangent of its angle.
    #[must_use]
    pub fn of_ratio(across: N::Signal) -> Self {
        let zero = N::Signal::default();
        let [cosine, sine, _] = N::unit([N::ONE, across, zero]).unwrap_or([N::ONE, zero, zero]);
        Self { cosine, sine }
    }
}

/// A rule with its memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfacePoint<N: Spatial> {
    /// The rule.
    pub rule: Rule<N>,
    /// Direction to the closest surface point in the last tick.
    side: Direction<N>,
    /// While inside: the direction in use, and the point at which the HIP entered.
    inside: Option<(Direction<N>, Vector<Position<N>>)>,
}

impl<N: Spatial> SurfacePoint<N> {
    /// Outside. An object with two sides has the HIP on that on which it is first seen.
    #[must_use]
    pub fn new(rule: Rule<N>) -> Self {
        Self {
            rule,
            side: Direction([N::Signal::default(); 3]),
            inside: None,
        }
    }

    /// Runs one control period: finds the surface point for a place.
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

/// The direction back to a point.
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
/// Seen from inside, a plane's closest point in the cone lies along its normal, or on the cone's side towards it. So of all ways out of an
/// object of planes the shortest is found; of others, the shortest of those along the cone's axis and towards their closest point.
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
    // Where no way leads out, the direction stays until one does.
    best.unwrap_or(Nearest {
        normal: *direction,
        depth: nearest.depth,
    })
}
