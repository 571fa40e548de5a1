//! A box with faces perpendicular to the coordinate axes.

use super::{Nearest, Surface, slanted};
use crate::Position;
use crate::space::number::Spatial;
use crate::space::vector::{Direction, Vector};

/// A box with faces perpendicular to the coordinate axes. The reported depth is exact for a point inside; for a point outside its
/// error is less than one step of the number format.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cuboid<N: Spatial> {
    /// Centre of the cuboid.
    pub centre: Vector<Position<N>>,
    /// Distance from the centre to the face on each axis.
    pub half: Vector<Position<N>>,
}

impl<N: Spatial> Surface<N> for Cuboid<N> {
    fn nearest(&self, at: Vector<Position<N>>, side: &Direction<N>) -> Nearest<N> {
        let from = at - self.centre;
        let beyond = from.zip(self.half, |x, half| x - x.within(half));
        if let Some(normal) = Direction::of(beyond) {
            return Nearest {
                normal,
                depth: -beyond.length_down(),
            };
        }
        let gaps = from.zip(self.half, |x, half| half - x.modulus()).0;
        let mut nearest = Nearest {
            normal: *side,
            depth: self.half.length_up(),
        };
        let sides = from.0.into_iter().zip(side.0);
        for (axis, (gap, (x, side))) in gaps.into_iter().zip(sides).enumerate() {
            if gap < nearest.depth {
                // In the middle between two faces the side of the last tick stays.
                let x = if x == Position::zero() {
                    Position(side)
                } else {
                    x
                };
                nearest = Nearest {
                    normal: Direction::along(axis, x < Position::zero()),
                    depth: gap,
                };
            }
        }
        nearest
    }
    fn exit(
        &self,
        at: Vector<Position<N>>,
        along: &Direction<N>,
        _: &Direction<N>,
    ) -> Option<Position<N>> {
        let from = at - self.centre;
        let faces = from.zip(self.half, |x, half| (x, half)).0;
        let outs = faces.into_iter().zip(along.0).filter_map(|((x, half), u)| {
            let ahead = if Position::<N>(u) < Position::zero() {
                -x
            } else {
                x
            };
            slanted(half - ahead, N::modulus(u))
        });
        outs.reduce(Position::min)
    }
    fn ways(&self, visit: &mut dyn FnMut(Direction<N>)) {
        for axis in 0..3 {
            visit(Direction::along(axis, false));
            visit(Direction::along(axis, true));
        }
    }
}
