//! A law of one degree of freedom that acts along the surface's normal (thesis §4.2, §4.5). The force is the law's force times the
//! direction out of the object.
//!
//! The law's offset, virtual mass and energy are scalars along the normal and turn with it. `docs/three-axes.md` calculates the
//! energy that this turning gives and takes. The law itself decides when the hand's point (HIP) has left the object. Outside, the
//! penetration is the negative distance to the surface, so the offset shifts the surface as in one degree of freedom.

use super::number::Spatial;
use super::scalar::Along;
use super::touch::{Touch, Track};
use super::vector::Vector;
use crate::Force;
use crate::law::Impact;

/// A law of one degree of freedom that acts along the surface's normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Magnitude<N: Spatial, L> {
    /// The law with its memory.
    pub law: L,
    /// Pulse and vibration that are added to the law's force at the touch; `None` for neither.
    pub impact: Option<Impact<N>>,
    track: Track<N>,
}

impl<N: Spatial, L: Along<N>> Magnitude<N, L> {
    /// A law without memory, outside the object and at rest.
    pub fn new(law: L) -> Self {
        Self {
            law,
            impact: None,
            track: Track::default(),
        }
    }

    /// This law with pulse and vibration at the touch.
    #[must_use]
    pub fn with_impact(self, impact: Option<Impact<N>>) -> Self {
        Self { impact, ..self }
    }

    /// Runs one control period; returns the force on the hand's point (HIP).
    #[inline]
    pub fn tick(&mut self, touch: &Touch<N>) -> Vector<Force<N>> {
        let sample = self.track.sample(touch);
        let mut force = self.law.tick(sample);
        if let Some(impact) = &mut self.impact {
            force = impact.with_pulse_and_vibration(sample, force);
        }
        self.track.keep(touch);
        touch.normal.times_force(force)
    }
}
