//! Force bounding on three axes: a vector spring, and one energy that bounds the length of its force.
//!
//! `E += F·Δx + (c_i/T) |Δx|²` and `|F| <= sqrt(4 E c_i/T)`, for a damping that is the same in all directions. The coefficients are
//! those of [`crate::law::Fba`]. Along a fixed normal, with a hand that moves along it, the force is the same as that law's.

use super::number::Spatial;
use super::touch::{Touch, Track};
use super::vector::Vector;
use crate::law::Fba;
use crate::{Energy, Force, Number, Position};

/// Vector force bounding around the spring `k_de`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounding<N: Spatial> {
    /// Coefficients of the force bounding law of one axis.
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

    /// Energy summed so far, J: taken from the hand and by the device's damping.
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
        // The force pushes: what the hand does against it is taken in.
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

/// Energy that the device's damping took over a displacement, rounded down.
fn damped<N: Number + Spatial>(law: &Fba<N>, moved: Vector<Position<N>>) -> Energy<N> {
    let [x, y, z] = moved
        .map(|part| crate::observer::damping_loss(law.device_damping, part))
        .0;
    x + y + z
}
