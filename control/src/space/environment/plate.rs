//! A plate that may be thinner than the depth to which a hand presses.

use super::{Cuboid, Nearest, Surface, slanted};
use crate::Position;
use crate::space::number::Spatial;
use crate::space::vector::{Direction, Vector};

/// A plate perpendicular to a coordinate axis. The plate keeps the hand's point (HIP) on the side from which the HIP came, for
/// any depth of a press and any displacement per tick. The HIP reaches the other side only around the plate's rim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plate<N: Spatial> {
    /// The body of the plate.
    pub body: Cuboid<N>,
    /// The coordinate axis perpendicular to the plate, 0 to 2 for x, y, z; larger numbers mean z.
    pub axis: usize,
}

impl<N: Spatial> Plate<N> {
    /// While the hand's point (HIP) is over the plate: depth below the face from which the HIP came, and that face's normal. Else
    /// `None`.
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
            // If the last tick gives no side (around the rim), the side is that on which the hand's point is.
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
