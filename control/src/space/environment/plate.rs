//! A thin plate, thinner than a press is deep.

use super::{Cuboid, Nearest, Surface, slanted};
use crate::Position;
use crate::space::number::Spatial;
use crate::space::vector::{Direction, Vector};

/// A plate across an axis that keeps the HIP on the side from which it came, however deep it is pressed or how far it moves in a
/// tick. Around its rim, and only there, the HIP comes to the other side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plate<N: Spatial> {
    /// The body of the plate.
    pub body: Cuboid<N>,
    /// The axis across which it lies, 0 to 2; others are z.
    pub axis: usize,
}

impl<N: Spatial> Plate<N> {
    /// The side from which the HIP came, while it is over the plate: the depth below that face, and its normal.
    fn kept(&self, at: Vector<Position<N>>, side: &Direction<N>) -> Option<Nearest<N>> {
        let from = at - self.body.centre;
        let axes = from.0.into_iter().zip(self.body.half.0).zip(side.0);
        let mut kept = None;
        for (axis, ((x, half), side)) in axes.enumerate() {
            if axis != self.axis.min(2) {
                if x.modulus() > half {
                    return None;
                }
                continue;
            }
            let side = Position::<N>(side);
            // Around the rim there is no side yet: that on which the HIP is.
            let side = if side == Position::zero() { x } else { side };
            let against = side < Position::zero();
            kept = Some(Nearest {
                normal: Direction::along(axis, against),
                depth: half - if against { -x } else { x },
            });
        }
        kept
    }
}

impl<N: Spatial> Surface<N> for Plate<N> {
    fn nearest(&self, at: Vector<Position<N>>, side: &Direction<N>) -> Nearest<N> {
        self.kept(at, side)
            .unwrap_or_else(|| self.body.nearest(at, side))
    }
    fn exit(
        &self,
        at: Vector<Position<N>>,
        along: &Direction<N>,
        side: &Direction<N>,
    ) -> Option<Position<N>> {
        let kept = self.kept(at, side)?;
        slanted(kept.depth, kept.normal.cosine(along))
    }
    fn ways(&self, visit: &mut dyn FnMut(Direction<N>)) {
        visit(Direction::along(self.axis, false));
        visit(Direction::along(self.axis, true));
    }
}
