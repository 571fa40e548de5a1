//! Three laws of one degree of freedom, one for each axis (thesis §4.4), with three rules for when a contact ends.
//!
//! The penetration `e` is a vector here. Each law gets the absolute value of its coordinate of `e`, negative outside, and pushes
//! to the side of the surface. When that side changes, the law's offset changes its side too, and the force jumps.
//!
//! **Equation (4.8) of the thesis has a wrong sign.** It ends a contact by comparing `e` with the projection of `O`, the vector
//! of the laws' offsets, on `e`. As printed, a contact would never end. This code follows the thesis' Fig. 4.9: the object is
//! left when `e` is longer than that projection and opposed to it. With the absolute values of §4.4 that is `Σ e_i² > Σ |e_i|
//! O_i`, without a division.

use super::number::Spatial;
use super::scalar::Along;
use super::touch::{Touch, Track};
use super::vector::{Direction, Vector};
use crate::law::{Contact, Sample};
use crate::{Energy, Force, Position};

/// The rule by which the contact of three single-axis laws ends after the hand's point (HIP) has left the object (thesis §4.4.1).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Leaving {
    /// Each axis ends its contact alone. A force can remain after the hand's point (HIP) has left the object.
    Decoupled,
    /// All axes end their contact as soon as one axis does. The force drops when a coordinate of the penetration is small.
    AnyAxis,
    /// All axes end their contact together, when the penetration is longer than the offset's projection on it (thesis, equation
    /// 4.8).
    #[default]
    Projection,
}

/// One law of one degree of freedom for each axis, and a rule for when their contact ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PerAxis<N: Spatial, L> {
    /// The laws with their memories.
    pub laws: [L; 3],
    /// The rule by which the contact of the three laws ends.
    pub leaving: Leaving,
    track: Track<N>,
    /// For each axis, whether the law's force pushes towards the negative side; a normal with a component of 0 keeps the side.
    negative: [bool; 3],
    /// Penetration along each axis in the last tick.
    last: Vector<Position<N>>,
}

impl<N: Spatial, L: Along<N>> PerAxis<N, L> {
    /// Laws without memory, outside the object and at rest.
    pub fn new(laws: [L; 3], leaving: Leaving) -> Self {
        Self {
            laws,
            leaving,
            track: Track::default(),
            negative: [false; 3],
            last: Vector::default(),
        }
    }

    /// Runs one control period; returns the force on the hand's point (HIP).
    pub fn tick(&mut self, touch: &Touch<N>) -> Vector<Force<N>> {
        let e = share_of(&touch.normal, touch.depth);
        let moved = self.displacements(touch, e);
        let mut force = Vector::default();
        let sides = self.negative.iter_mut().zip(touch.normal.0);
        let laws = self.laws.iter_mut().zip(e.0.into_iter().zip(moved.0));
        for (out, ((law, (e, moved)), (negative, normal))) in
            force.0.iter_mut().zip(laws.zip(sides))
        {
            if Position::<N>(normal) != Position::zero() {
                *negative = Position::<N>(normal) < Position::zero();
            }
            let size = law.tick(Sample { e, moved });
            *out = if *negative {
                Force::zero() - size
            } else {
                size
            };
        }
        self.track.keep(touch);
        self.last = e;
        if self.has_left(touch, e) {
            self.laws.iter_mut().for_each(Along::reset);
            return Vector::default();
        }
        force
    }

    /// Splits the displacement along the last tick's normal into a part for each axis. On a flat surface a part is the change of
    /// that axis' penetration, bit for bit.
    fn displacements(&self, touch: &Touch<N>, e: Vector<Position<N>>) -> Vector<Position<N>> {
        let normal = self.track.normal().unwrap_or(touch.normal);
        let Sample { moved, .. } = self.track.sample(touch);
        // The cheapest comparison comes first: it usually fails already if the normal turns.
        let straight = moved == touch.depth - self.track.depth();
        if straight && touch.moved.is_none() && normal == touch.normal {
            return e - self.last;
        }
        share_of(&normal, moved)
    }

    /// Whether the hand's point (HIP) has left the object, by the chosen rule.
    fn has_left(&self, touch: &Touch<N>, e: Vector<Position<N>>) -> bool {
        if touch.depth >= Position::zero() {
            return false;
        }
        let [x, y, z] = &self.laws;
        let views = [x, y, z].map(Along::view);
        let touches = views.iter().any(|law| law.contact != Contact::Free);
        touches && self.leaving.ends(e, Vector(views.map(|law| law.offset)))
    }
}

impl Leaving {
    /// Whether the contact ends by this rule while the hand's point is outside. Takes the penetration along each axis (none
    /// positive) and the offset (none negative).
    #[inline]
    pub fn ends<N: Spatial>(self, e: Vector<Position<N>>, offset: Vector<Position<N>>) -> bool {
        let reach = e + offset;
        match self {
            Self::Decoupled => false,
            Self::AnyAxis => reach.0.iter().any(|reach| *reach < Position::zero()),
            Self::Projection => {
                // e_i (e_i + O_i) = e_i² - |e_i| O_i, exact unless it saturates.
                let [x, y, z] = e.zip(reach, |e, reach| Force::<N>(e.0) * reach).0;
                x + y + z > Energy::zero()
            }
        }
    }
}

/// Splits a length along a direction into absolute values for each axis, rounded towards zero. Each has the sign of the length.
#[inline(always)]
fn share_of<N: Spatial>(along: &Direction<N>, length: Position<N>) -> Vector<Position<N>> {
    Vector(N::share_of_length(along.0, length.0).map(Position))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Fixed8;

    /// Checks for every direction component and every length of 8 bits: the part of the length for an axis has the length's sign.
    #[test]
    fn a_share_of_a_length_is_the_part_along_a_direction_without_its_side() {
        for u in i8::MIN..=i8::MAX {
            let along =
                Direction::<Fixed8>([u, 0, 64].map(<Fixed8 as crate::Number>::Signal::from_bits));
            for length in i8::MIN..=i8::MAX {
                let length =
                    Position::<Fixed8>(<Fixed8 as crate::Number>::Signal::from_bits(length));
                let [part, none, up] = along.times(length).0;
                let expected = if u < 0 { -part } else { part };
                assert_eq!(
                    share_of(&along, length),
                    Vector([expected, none, up]),
                    "{u} of {length:?}"
                );
            }
        }
    }
}
