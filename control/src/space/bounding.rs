//! Force bounding on three axes: a spring that gives a force vector, and one energy that bounds the length of the force.
//!
//! The energy `E` sums what the hand and the device's damping `c_i` give: `E += -F·Δx + (c_i/T) |Δx|²`, with the force `F` on the
//! hand's point (HIP), displacement `Δx` and control period `T`. The bound is `|F| <= sqrt(4 E c_i/T)`, for a damping that is the
//! same in all directions. The coefficients are those of [`crate::law::Fba`]. If the hand moves along a fixed normal, the force
//! is that law's.

use super::number::Spatial;
use super::touch::{Touch, Track};
use super::vector::Vector;
use crate::law::Fba;
use crate::{Energy, Force, Number, Position};

/// Force bounding around a spring on three axes: limits the length of the force vector to what energy and damping allow.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounding<N: Spatial> {
    /// Coefficients of the force bounding law of one axis, used here for lengths.
    pub law: Fba<N>,
    track: Track<N>,
    energy: Energy<N>,
    force: Vector<Force<N>>,
}

impl<N: Spatial> Bounding<N> {
    /// A law without memory, outside the object and at rest.
    pub fn new(law: Fba<N>) -> Self {
        Self {
            law,
            track: Track::default(),
            energy: Energy::zero(),
            force: Vector::default(),
        }
    }

    /// Energy summed so far, J: given by the hand, and dissipated by the device's damping.
    pub fn energy(&self) -> Energy<N> {
        self.energy
    }

    /// Runs one control period; returns the force on the hand's point (HIP).
    pub fn tick(&mut self, touch: &Touch<N>) -> Vector<Force<N>> {
        let moved = self.track.moved(touch);
        self.track.keep(touch);
        if touch.depth <= Position::zero() {
            (self.energy, self.force) = (Energy::zero(), Vector::default());
            return self.force;
        }
        // The force pushes the hand, so a motion of the hand against the force puts energy in.
        let absorbed = (-self.force).work(moved);
        self.energy = (self.energy + absorbed + damped(&self.law, moved)).min(self.law.energy_cap);
        let wanted = (self.law.desired * touch.depth).towards_zero();
        let bound = self.law.largest_force(self.energy);
        self.force = touch
            .normal
            .times_force(wanted.min(self.law.limit).min(bound));
        self.force
    }
}

/// Energy that the device's damping dissipated over a displacement, rounded down.
fn damped<N: Number + Spatial>(law: &Fba<N>, moved: Vector<Position<N>>) -> Energy<N> {
    let [x, y, z] = moved
        .map(|part| crate::observer::damping_loss(law.device_damping, part))
        .0;
    x + y + z
}
