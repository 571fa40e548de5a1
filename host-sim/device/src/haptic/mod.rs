//! A haptic device: reads positions, commands forces, reports its state and faults.
//!
//! The trait [`HapticDevice`] covers everything on which a wall can be rendered. Positions and forces have three axes in the
//! device's own frame. A device with one degree of freedom uses the first axis and leaves the others at 0. [`OneAxis`] makes such a
//! device from one axis of any device. A [`HapticFault`] is a device's fault; [`Injected`] lets a test cause one in any device.

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

/// A device's data that are known before it moves.
#[derive(Debug, Clone, PartialEq)]
pub struct DataSheet {
    /// Description for people: model, serial number, version.
    pub name: String,
    /// Degrees of freedom in which a force acts: 1 or 3.
    pub degrees: usize,
    /// Largest force of the device, N.
    pub force_n: f64,
    /// Range of positions that the end effector can reach, relative to the origin of the device's frame.
    pub workspace: Workspace,
    /// Resolution of the measured position (distance per encoder count), m.
    pub count_m: f64,
    /// Slowest and fastest control rate, Hz.
    pub rates_hz: (u32, u32),
    /// Time from measuring a position until the force calculated from it acts, s; assumed if it was not measured.
    pub delay_s: f64,
    /// Mass (kg) and damping (N·s/m) of each axis; `None` if they are neither published nor measured.
    pub axes: Option<[Device; 3]>,
    /// Least damping in the workspace in any direction, N·s/m; `None` if it is neither published nor measured.
    pub least_damping_n_s_per_m: Option<f64>,
    /// Whether [`HapticDevice::sense`] waits for the device, so that the device sets the rate of the servo loop.
    pub sets_the_pace: bool,
}

/// The workspace: a cylinder around the origin with a vertical axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Workspace {
    /// Radius of the workspace, m.
    pub radius_m: f64,
    /// Half of the workspace's height, m.
    pub half_height_m: f64,
}

impl Workspace {
    /// How far a position is outside the workspace, m; 0 for a position inside.
    #[must_use]
    pub fn outside_m(&self, [x, y, z]: [f64; 3]) -> f64 {
        let across = (x.hypot(y) - self.radius_m).max(0.0);
        let along = (z.abs() - self.half_height_m).max(0.0);
        across.hypot(along)
    }
}

/// A position that the device returned.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensed {
    /// Position of the end effector, m.
    pub position_m: [f64; 3],
    /// Whether the position was measured for this call. If false, it is a repetition of the last one.
    pub fresh: bool,
}

/// Whether the whole commanded force acts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Applied {
    /// The whole commanded force acts.
    Whole,
    /// The motors give less force in the same direction. Holds the acting force, N, if the device reports it.
    Saturated(Option<[f64; 3]>),
}

/// The state of a device: supply, calibration, motors.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DeviceStanding {
    /// Whether the device has its supply.
    pub powered: bool,
    /// Whether the device is calibrated.
    pub calibrated: bool,
    /// Whether the motors are on.
    pub motors_on: bool,
    /// Why the device switched its motors off without a command; `None` if it did not.
    pub switched_off: Option<SwitchOff>,
}

/// A device that can give a force.
///
/// How long a call may last depends on the device: an Inverse3's answer has a deadline, a call of an omega.3's library has none. After
/// a fault only [`HapticDevice::release`] may be called.
pub trait HapticDevice {
    /// The device's data sheet.
    fn sheet(&self) -> &DataSheet;

    /// Switches the motors on, with no force.
    ///
    /// # Errors
    /// The device cannot be used, permanently or at present.
    fn engage(&mut self) -> Result<(), HapticFault>;

    /// Reads the present position. A device that sets the servo loop's rate waits for its next position.
    ///
    /// # Errors
    /// No position could be read.
    fn sense(&mut self) -> Result<Sensed, HapticFault>;

    /// Commands the force on the hand, N. It acts until the next command.
    ///
    /// # Errors
    /// The force does not act.
    fn command(&mut self, force_n: [f64; 3]) -> Result<Applied, HapticFault>;

    /// Requests the device's state.
    ///
    /// # Errors
    /// The device does not answer.
    fn standing(&mut self) -> Result<DeviceStanding, HapticFault>;

    /// Sets the force to zero, switches the motors off and closes the device. Tries every step a bounded number of times, even if
    /// another step failed. A second call does nothing.
    ///
    /// # Errors
    /// A step failed in every attempt; the other steps were done.
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
        // 3 mm beyond the radius and 4 mm beyond the height are a distance of 5 mm.
        assert!((space.outside_m([0.083, 0.0, -0.059]) - 0.005).abs() < 1e-12);
    }
}
