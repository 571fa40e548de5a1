//! A texture: shallow grooves in the surface of a virtual object.
//!
//! The grooves are planes of equal phase through the object, `period` apart along one direction. The depth below the textured surface
//! is `depth + height/2 · sin(2π s/period)`, where `s` is the coordinate along that direction. The force stays along the normal of the
//! smooth object. So it is not the gradient of an energy: a hand that goes in where the surface is low and out where it is high
//! gets energy. The law does not count that. The energy guard of the shipped wall does, because it multiplies force and displacement;
//! the thesis' approaches have no guard.

use std::f64::consts::TAU;
use touchstone_control::space::{Direction, Nearest, Surface, Vector};
use touchstone_control::{Fixed32, Position};

type N = Fixed32;

/// Shortest and longest distance between two ridges, mm.
pub const PERIODS_MM: [f64; 2] = [0.2, 100.0];
/// Largest ratio of a ridge's height to the period. The force stays along the smooth object's normal, so steeper flanks would not
/// be felt as such.
pub const STEEPEST: f64 = 0.1;
/// Largest height of a ridge over a groove, mm. The hand begins 3 mm above the smooth surface.
pub const HIGHEST_MM: f64 = 5.0;

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
    /// Checks the values, and makes the direction a unit vector.
    ///
    /// # Errors
    /// Name of the field that is out of range, and its range.
    pub fn validated(self) -> Result<Self, (&'static str, String)> {
        let [least, most] = PERIODS_MM;
        if !(least..=most).contains(&self.period_mm) {
            return Err(("period_mm", format!("must be {least} to {most}")));
        }
        // The factor lets a tenth pass that the computer's numbers do not represent exactly.
        let most_mm = HIGHEST_MM.min(STEEPEST * self.period_mm * (1.0 + 1e-12));
        if !(self.height_mm > 0.0 && self.height_mm <= most_mm) {
            let range =
                format!("must be above 0, at most {STEEPEST} of period_mm and {HIGHEST_MM}");
            return Err(("height_mm", range));
        }
        let length = self.along.iter().map(|x| x * x).sum::<f64>().sqrt();
        if !(length.is_finite() && length > 0.0) {
            let range = "must be a direction: three numbers that are not all 0";
            return Err(("along", range.to_owned()));
        }
        Ok(Self {
            along: self.along.map(|x| x / length),
            ..self
        })
    }

    /// Height of the textured surface over the smooth one at a position, mm: -height/2 to height/2.
    #[must_use]
    pub fn above_mm(&self, at_mm: [f64; 3]) -> f64 {
        let s: f64 = (0..3).map(|axis| at_mm[axis] * self.along[axis]).sum();
        0.5 * self.height_mm * libm::sin(TAU * s / self.period_mm)
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
