//! A cylinder along a coordinate axis.

use super::sphere::chord;
use super::{Nearest, Surface, slanted};
use crate::Position;
use crate::space::number::Spatial;
use crate::space::vector::{Direction, Vector};

/// A cylinder with flat ends. The error of the reported depth is less than one step of the number format, and less than four
/// steps at the rim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder<N: Spatial> {
    /// Centre of the cylinder.
    pub centre: Vector<Position<N>>,
    /// Radius of the cylinder.
    pub radius: Position<N>,
    /// Distance from the centre to each end.
    pub half: Position<N>,
    /// The coordinate axis along which the cylinder lies, 0 to 2 for x, y, z; larger numbers mean z.
    pub axis: usize,
}

impl<N: Spatial> Cylinder<N> {
    /// Splits a vector into the part perpendicular to the cylinder's axis and the component along it.
    fn split(&self, v: Vector<Position<N>>) -> (Vector<Position<N>>, Position<N>) {
        let [x, y, z] = v.0;
        let none = Position::zero();
        match self.axis {
            0 => (Vector([none, y, z]), x),
            1 => (Vector([x, none, z]), y),
            _ => (Vector([x, y, none]), z),
        }
    }
}

impl<N: Spatial> Surface<N> for Cylinder<N> {
    fn nearest(&self, at: Vector<Position<N>>, side: &Direction<N>) -> Nearest<N> {
        let (radial, along) = self.split(at - self.centre);
        let around = || {
            let (was, _) = self.split(Vector(side.0.map(Position)));
            let any = Direction::along(if self.axis == 0 { 1 } else { 0 }, false);
            // On the axis all points of the wall are equally close: the direction of the last tick stays.
            Direction::of(radial).or(Direction::of(was)).unwrap_or(any)
        };
        let end = Direction::along(self.axis, along < Position::zero());
        let wall = self.radius - radial.length_down();
        let cap = self.half - along.modulus();
        if wall < Position::zero() && cap < Position::zero() {
            let beyond = around().times(-wall) + end.times(-cap);
            return Nearest {
                normal: Direction::of(beyond).unwrap_or(end),
                depth: -beyond.length_down(),
            };
        }
        if wall < cap {
            return Nearest {
                normal: around(),
                depth: wall,
            };
        }
        Nearest {
            normal: end,
            depth: cap,
        }
    }
    fn exit(
        &self,
        at: Vector<Position<N>>,
        along: &Direction<N>,
        _: &Direction<N>,
    ) -> Option<Position<N>> {
        let (radial, height) = self.split(at - self.centre);
        let (across, rise) = self.split(Vector(along.0.map(Position)));
        let ahead = if rise < Position::zero() {
            -height
        } else {
            height
        };
        let cap = slanted(self.half - ahead, rise.modulus().0);
        let wall = Direction::of(across).and_then(|direction| {
            let far = chord(self.radius, radial, &direction);
            slanted(far, across.length_down().0)
        });
        match (cap, wall) {
            (Some(cap), Some(wall)) => Some(cap.min(wall)),
            (cap, wall) => cap.or(wall),
        }
    }
    fn ways(&self, visit: &mut dyn FnMut(Direction<N>)) {
        visit(Direction::along(self.axis, false));
        visit(Direction::along(self.axis, true));
    }
}
