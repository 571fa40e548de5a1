//! A texture: shallow grooves in the surface of a virtual object.
//!
//! The grooves are planes of equal phase through the object, `period` apart along one direction. The depth below the textured surface
//! is `depth + height/2 · sin(2π s/period)`, where `s` is the coordinate along that direction. The force stays along the normal of the
//! smooth object. So it is not the gradient of an energy: a hand that goes in where the surface is low and out where it is high
//! gets energy. The law does not count that. The energy guard of the shipped wall does, because it multiplies force and displacement;
//! the thesis' approaches have no guard.

use super::N;
use std::f64::consts::TAU;
use touchstone_control::Position;
use touchstone_control::space::{Direction, Nearest, Surface, Vector};

/// Shape of the grooves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Texture {
    /// Height of a ridge over a groove, mm.
    pub height_mm: f64,
    /// Distance between two ridges along `along`, mm.
    pub period_mm: f64,
    /// Unit vector across the grooves.
    pub along: [f64; 3],
}

impl Texture {
    /// Height of the textured surface over the smooth one at a position, mm: -height/2 to height/2.
    #[must_use]
    pub fn above_mm(&self, at_mm: [f64; 3]) -> f64 {
        let s: f64 = (0..3).map(|axis| at_mm[axis] * self.along[axis]).sum();
        0.5 * self.height_mm * (TAU * s / self.period_mm).sin()
    }
}

/// An object with a texture, or with a smooth surface if there is none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Textured<S> {
    /// The smooth object.
    pub smooth: S,
    /// The grooves in its surface; `None` for a smooth surface.
    pub texture: Option<Texture>,
}

/// Number of millimetres in the laws' unit of length, the centimetre.
const MM: f64 = 10.0;

impl<S> Textured<S> {
    fn deepened(&self, at: Vector<Position<N>>, depth: Position<N>) -> Position<N> {
        match &self.texture {
            None => depth,
            Some(texture) => {
                let above_mm = texture.above_mm(at.0.map(|x| x.to_f64() * MM));
                depth + Position::from_f64(above_mm / MM)
            }
        }
    }
}

impl<S: Surface<N>> Surface<N> for Textured<S> {
    fn nearest(&self, at: Vector<Position<N>>, side: &Direction<N>) -> Nearest<N> {
        let smooth = self.smooth.nearest(at, side);
        Nearest {
            depth: self.deepened(at, smooth.depth),
            ..smooth
        }
    }
    // Right along the normal only. The rule that asks for other directions is not used with a texture.
    fn exit(
        &self,
        at: Vector<Position<N>>,
        along: &Direction<N>,
        side: &Direction<N>,
    ) -> Option<Position<N>> {
        let smooth = self.smooth.exit(at, along, side)?;
        Some(self.deepened(at, smooth))
    }
    fn ways(&self, visit: &mut dyn FnMut(Direction<N>)) {
        self.smooth.ways(visit);
    }
    fn is_round(&self) -> bool {
        self.smooth.is_round()
    }
}
