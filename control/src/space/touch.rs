//! The contact of the hand's point with an object, and the motion along the normal, as input of the laws on three axes.

use super::environment::Nearest;
use super::number::Spatial;
use super::vector::{Direction, Vector};
use crate::Position;
use crate::law::Sample;

/// Position of the hand's point (HIP) with respect to the surface of an object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch<N: Spatial> {
    /// Position of the hand's point (HIP).
    pub at: Vector<Position<N>>,
    /// The normal out of the object, along which the force pushes.
    pub normal: Direction<N>,
    /// How deep the hand's point (HIP) is below the surface point, positive inside.
    pub depth: Position<N>,
    /// Displacement per tick if it is estimated; `None` means the displacement since the last tick.
    pub moved: Option<Vector<Position<N>>>,
}

impl<N: Spatial> Touch<N> {
    /// The contact at a measured position, relative to the given surface point.
    #[inline(always)]
    #[must_use]
    pub fn measured(at: Vector<Position<N>>, seen: Nearest<N>) -> Self {
        Self {
            at,
            normal: seen.normal,
            depth: seen.depth,
            moved: None,
        }
    }
}

/// Memory of the last tick's contact, from which displacements are calculated.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Track<N: Spatial> {
    last: Option<(Vector<Position<N>>, Nearest<N>)>,
}

/// Whether a change of the penetration differs from the displacement along the normal by no more than the rounding of two
/// projections.
fn is_rounding<N: Spatial>(change: Position<N>, moved: Position<N>) -> bool {
    let two = Position::quantum() + Position::quantum();
    (change - moved).modulus() <= two
}

impl<N: Spatial> Track<N> {
    /// Displacement of the hand's point (HIP) as a vector. If it is not estimated, it is zero in the first tick.
    #[inline]
    #[must_use]
    pub fn moved(&self, touch: &Touch<N>) -> Vector<Position<N>> {
        touch.moved.unwrap_or_else(|| {
            self.last
                .map_or(Vector::default(), |(last, _)| touch.at - last)
        })
    }

    /// Penetration, and displacement inward along the normal **of the last tick**. The last force acted along that normal, so force
    /// times displacement is the work at the hand.
    ///
    /// On a flat surface the displacement is the change of the penetration, bit for bit, as in one degree of freedom. An estimated
    /// displacement is projected on the same normal.
    #[inline]
    #[must_use]
    pub fn sample(&self, touch: &Touch<N>) -> Sample<N> {
        let e = touch.depth;
        if let Some(moved) = touch.moved {
            let normal = self.normal().unwrap_or(touch.normal);
            return Sample {
                e,
                moved: normal.opposite().component(moved),
            };
        }
        let Some((at, last)) = &self.last else {
            return Sample::measured(e, Position::zero());
        };
        let change = e - last.depth;
        // Rounded down, so that no law counts more inward work than the hand did.
        let moved = last.normal.opposite().component(touch.at - *at);
        let straight = last.normal == touch.normal && is_rounding(change, moved);
        Sample {
            e,
            moved: if straight { change } else { moved },
        }
    }

    /// The normal of the last tick; `None` before the first tick.
    #[must_use]
    pub fn normal(&self) -> Option<Direction<N>> {
        self.last.map(|(_, last)| last.normal)
    }

    /// The penetration of the last tick; 0 before the first.
    #[must_use]
    pub fn depth(&self) -> Position<N> {
        self.last.map_or(Position::zero(), |(_, last)| last.depth)
    }

    /// Stores the contact for the next tick.
    #[inline]
    pub fn keep(&mut self, touch: &Touch<N>) {
        let seen = Nearest {
            normal: touch.normal,
            depth: touch.depth,
        };
        self.last = Some((touch.at, seen));
    }
}
