//! A haptic device: position in, force out, state, faults.
//!
//! One small trait for everything that a wall can be displayed on. Positions and forces have three axes in the device's own
//! frame. A device of one degree of freedom uses the first and leaves the others at 0, and one axis of three is a device of
//! one as well, [`OneAxis`]. What a device may do wrong is a [`HapticFault`], and can be made to happen around any of them:
//! [`Injected`].

mod fault;
mod injected;
mod one_axis;
mod simulated;
mod simulated_delta;

pub use fault::{HapticFault, SwitchOff};
pub use injected::{DeviceCall, FaultInjection, FaultKind, Injected};
pub use one_axis::OneAxis;
pub use simulated::{DeviceTwin, Rest, SimulatedArm};
pub use simulated_delta::{FALCON_RATE_HZ, SimulatedDelta};

use touchstone_world::plant::Device;

/// Data of a device that are known before it moves.
#[derive(Debug, Clone, PartialEq)]
pub struct DataSheet {
    /// Description for people: model, serial number, version.
    pub name: String,
    /// Degrees of freedom in which a force acts: 1 or 3.
    pub degrees: usize,
    /// The longest force that it gives, N.
    pub force_n: f64,
    /// Where it may be held, m from the origin of its frame.
    pub workspace: Workspace,
    /// Step of a measured position, m.
    pub count_m: f64,
    /// Slowest and fastest control rate, Hz.
    pub rates_hz: (u32, u32),
    /// Time from a position until its force acts, s; assumed where it was not measured.
    pub delay_s: f64,
    /// Mass and damping of each axis, where published or measured.
    pub axes: Option<[Device; 3]>,
    /// Least damping in the workspace in any direction, N·s/m, where published or measured.
    pub least_damping_n_s_per_m: Option<f64>,
    /// Whether [`HapticDevice::sense`] waits for the device: its pace is then the loop's.
    pub sets_the_pace: bool,
}

/// An upright cylinder around the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Workspace {
    /// Radius of the workspace, m.
    pub radius_m: f64,
    /// Half of its height, m.
    pub half_height_m: f64,
}

impl Workspace {
    /// How far a place is outside, m; 0 inside.
    #[must_use]
    pub fn outside_m(&self, [x, y, z]: [f64; 3]) -> f64 {
        let across = (x.hypot(y) - self.radius_m).max(0.0);
        let along = (z.abs() - self.half_height_m).max(0.0);
        across.hypot(along)
    }
}

/// A position that was read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensed {
    /// Place of the end effector, m.
    pub position_m: [f64; 3],
    /// Whether it was measured for this call; otherwise it is the last one again.
    pub fresh: bool,
}

/// What became of a force.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Applied {
    /// The whole force acts.
    Whole,
    /// The motors give less, in the same direction; holds the acting force, N, if the device reports it.
    Saturated(Option<[f64; 3]>),
}

/// Where a device stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DeviceStanding {
    /// The device has its supply.
    pub powered: bool,
    /// The device is calibrated.
    pub calibrated: bool,
    /// The motors are on.
    pub motors_on: bool,
    /// Why they do not, where the device itself switched them off.
    pub switched_off: Option<SwitchOff>,
}

/// A device with a force.
///
/// Every call returns: none waits without end. After a fault only [`HapticDevice::release`] may follow.
pub trait HapticDevice {
    /// The known data of the device.
    fn sheet(&self) -> &DataSheet;

    /// Motors on, at no force.
    ///
    /// # Errors
    /// The device cannot be used, or not now.
    fn engage(&mut self) -> Result<(), HapticFault>;

    /// The position now; a device that sets the pace waits for its next one.
    ///
    /// # Errors
    /// No position could be read.
    fn sense(&mut self) -> Result<Sensed, HapticFault>;

    /// The force on the hand from now on, N.
    ///
    /// # Errors
    /// The force does not act.
    fn command(&mut self, force_n: [f64; 3]) -> Result<Applied, HapticFault>;

    /// Where it stands; asks the device.
    ///
    /// # Errors
    /// The device does not answer.
    fn standing(&mut self) -> Result<DeviceStanding, HapticFault>;

    /// No force, motors off, and the device free for others. Tries everything a bounded number of times whatever fails, and does nothing
    /// the second time.
    ///
    /// # Errors
    /// A part of the release failed in every try; the rest was done.
    fn release(&mut self) -> Result<(), HapticFault>;
}

impl<D: HapticDevice + ?Sized> HapticDevice for Box<D> {
    fn sheet(&self) -> &DataSheet {
        (**self).sheet()
    }
    fn engage(&mut self) -> Result<(), HapticFault> {
        (**self).engage()
    }
    fn sense(&mut self) -> Result<Sensed, HapticFault> {
        (**self).sense()
    }
    fn command(&mut self, force_n: [f64; 3]) -> Result<Applied, HapticFault> {
        (**self).command(force_n)
    }
    fn standing(&mut self) -> Result<DeviceStanding, HapticFault> {
        (**self).standing()
    }
    fn release(&mut self) -> Result<(), HapticFault> {
        (**self).release()
    }
}

/// Length of a vector.
#[must_use]
pub fn length([x, y, z]: [f64; 3]) -> f64 {
    x.hypot(y).hypot(z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_workspace_says_how_far_outside() {
        let space = Workspace {
            radius_m: 0.08,
            half_height_m: 0.055,
        };
        assert_eq!(space.outside_m([0.048, 0.064, -0.055]), 0.0);
        // 3 mm across and 4 mm along are 5 mm.
        assert!((space.outside_m([0.083, 0.0, -0.059]) - 0.005).abs() < 1e-12);
    }
}
