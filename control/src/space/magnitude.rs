//! One law along the normal (thesis §4.2, §4.5): its force times the direction out.
//!
//! Memory belongs to the magnitude and turns with the normal: offset, virtual mass and energy are scalars along it. What that
//! gives and takes is on paper in `docs/three-axes.md`. Whether the HIP has left is the law's own matter: outside, its
//! penetration is the negative distance to the surface, and the offset reaches as far as it does in one degree of freedom.

use super::number::Spatial;
use super::scalar::Along;
use super::touch::{Touch, Track};
use super::vector::Vector;
use crate::Force;

/// A law along the normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Magnitude<N: Spatial, L> {
    /// The law with its memory.
    pub law: L,
    track: Track<N>,
}

impl<N: Spatial, L: Along<N>> Magnitude<N, L> {
    /// A law without memory, outside the object and at rest.
    pub fn new(law: L) -> Self {
        Self {
            law,
            track: Track::default(),
        }
    }

    /// Runs one control period; returns the force on the HIP.
    #[inline]
    pub fn tick(&mut self, touch: &Touch<N>) -> Vector<Force<N>> {
        let force = self.law.tick(self.track.sample(touch));
        self.track.keep(touch);
        touch.normal.times_force(force)
    }
}
