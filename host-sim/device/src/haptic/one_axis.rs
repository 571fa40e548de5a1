//! One axis of a device, with its position and force as single numbers.

use super::{Applied, HapticDevice, HapticFault};

/// A device with one degree of freedom: one axis of another device. The force on the other axes is zero.
#[derive(Debug)]
pub struct OneAxis<D> {
    device: D,
    axis: usize,
}

impl<D: HapticDevice> OneAxis<D> {
    /// Uses axis 0, 1 or 2 of a device; only 0 for a device with one degree of freedom.
    ///
    /// # Errors
    /// The device has no such axis.
    pub fn new(device: D, axis: usize) -> Result<Self, HapticFault> {
        if axis < device.sheet().degrees {
            return Ok(Self { device, axis });
        }
        Err(HapticFault::Unusable(
            format!("{} has no axis {axis}", device.sheet().name),
            "choose an axis of the device".into(),
        ))
    }

    /// The underlying device with all its axes, e.g. to engage and release it.
    pub fn device(&mut self) -> &mut D {
        &mut self.device
    }

    /// The present position along the axis, m.
    ///
    /// # Errors
    /// Same as [`HapticDevice::sense`].
    pub fn sense(&mut self) -> Result<f64, HapticFault> {
        Ok(self.device.sense()?.position_m[self.axis])
    }

    /// Commands the force along the axis, N. It acts until the next command.
    ///
    /// # Errors
    /// Same as [`HapticDevice::command`].
    pub fn command(&mut self, force_n: f64) -> Result<Applied, HapticFault> {
        let mut force = [0.0; 3];
        force[self.axis] = force_n;
        self.device.command(force)
    }
}
