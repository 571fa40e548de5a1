//! A short torque at the touch (event-based haptics): it takes the device's momentum away in the first control periods inside a
//! wall.
//!
//! A stiff spring alone needs a quarter of the oscillation period of device and spring to stop the device, which feels like foam.
//! People judge hardness by the first milliseconds of a tap (Kuchenbecker, Fiene and Niemeyer, IEEE TVCG 12(2) 219, 2006). A
//! braking pulse at the entry stops the device in one or two control periods (Salcudean and Vlaar, J. Dyn. Sys. Meas. Control
//! 119(1) 127, 1997).
//!
//! At the first control period inside the wall the pulse has the impulse `s J v`: a fraction `s` of the momentum of the inertia
//! `J` at the speed `v`. Each control period adds as much of the remaining impulse to the law's force as the force limit allows.
//! The rest is dropped when the motion turns or the device leaves the wall. The energy guard limits the sum of both forces. Speed
//! and inertia are those of the state estimator; a law on measured states has no pulse.

use super::{Sample, Vibration};
use crate::{Force, Number, Position, Stiffness};

/// The pulse at the touch of one wall, with its memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Impact<N: Number> {
    /// Gain `s J/T²` from the displacement in a control period to a force. Over one control period this force takes away the
    /// fraction `s` of the momentum.
    pub brake: Stiffness<N>,
    /// Largest sum of the law's force and the pulse.
    pub limit: Force<N>,
    /// Control periods outside the wall after which an entry is a new touch. Noise and chatter at the surface return sooner, so
    /// they are no new touch.
    pub apart: u16,
    /// The part of the pulse's impulse that has not been added to the force yet, divided by the control period.
    pub left: Force<N>,
    /// Control periods since the device was inside the wall, at most [`Impact::apart`].
    pub outside: u16,
    /// The vibration that begins with the pulse; `None` if the settings have none.
    pub vibration: Option<Vibration<N>>,
}

impl<N: Number> Impact<N> {
    /// Runs one control period: takes the law's input and the law's force, returns the force with pulse and vibration.
    #[inline(always)]
    pub fn with_pulse_and_vibration(&mut self, sample: Sample<N>, force: Force<N>) -> Force<N> {
        let touch = self.outside == self.apart;
        let force = self.with_pulse(sample, force);
        match &mut self.vibration {
            None => force,
            Some(vibration) => vibration.with_vibration(sample, touch, force, self.limit),
        }
    }

    /// Takes the law's input and the law's force, returns the force with the pulse and without the vibration.
    #[inline(always)]
    pub fn with_pulse(&mut self, sample: Sample<N>, force: Force<N>) -> Force<N> {
        if sample.e <= Position::zero() {
            self.outside = self.outside.saturating_add(1).min(self.apart);
            self.left = Force::zero();
            return force;
        }
        let touch = self.outside == self.apart;
        self.outside = 0;
        if touch {
            self.left = (self.brake * sample.moved).towards_zero();
        } else if self.left == Force::zero() {
            // The rest of a contact, in as few instructions as possible.
            return force;
        }
        if sample.moved <= Position::zero() {
            self.left = Force::zero();
        }
        let pulse = self.left.min(self.limit - force).max(Force::zero());
        self.left = self.left - pulse;
        force + pulse
    }

    /// Clears the memory, as after a long time outside the wall.
    pub fn forget_touch(&mut self) {
        self.left = Force::zero();
        self.outside = self.apart;
        if let Some(vibration) = &mut self.vibration {
            vibration.left = 0;
        }
    }
}
