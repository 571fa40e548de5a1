//! One axis of a device, with scalar position and force.

use super::{Applied, HapticDevice, HapticFault};

/// A device of one degree of freedom, along an axis of another; the other axes are free.
#[derive(Debug)]
pub struct OneAxis<D> {
    device: D,
    axis: usize,
}

impl<D: HapticDevice> OneAxis<D> {
    /// Along axis 0 to 2 of a device; of a device of one degree of freedom, 0.
    ///
    /// # Errors
    /// The device has no such axis.
    pub fn new(device: D, axis: usize) -> Result<Self, HapticFault> {
        if axis < device.sheet().degrees {
            return Ok(Self { device, axis });
        }
        Err(HapticFault::Unusable(
            format!("{} has no axis {axis}", device.sheet().name),
            "choose one that it has".into(),
        ))
    }

    /// The device, e.g. to engage and release it.
    pub fn device(&mut self) -> &mut D {
        &mut self.device
    }

    /// The coordinate now, m.
    ///
    /// # Errors
    /// Same as [`HapticDevice::sense`].
    pub fn sense(&mut self) -> Result<f64, HapticFault> {
        Ok(self.device.sense()?.position_m[self.axis])
    }

    /// The force along the axis from now on, N.
    ///
    /// # Errors
    /// Same as [`HapticDevice::command`].
    pub fn command(&mut self, force_n: f64) -> Result<Applied, HapticFault> {
        let mut force = [0.0; 3];
        force[self.axis] = force_n;
        self.device.command(force)
    }
}
