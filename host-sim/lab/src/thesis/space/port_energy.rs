//! The energy that a simulated user gets out of a wall on three axes.

/// Energy through the ports of wall and user.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PortEnergy {
    /// Energy that the wall has taken so far, J.
    wall_j: f64,
    /// Energy that the device has dissipated so far, J.
    loss_j: f64,
    /// Sum of the magnitudes of the energies through the wall's port, J.
    throughput_j: f64,
    /// Lowest value so far of the energy that the user put in, J; negative if the user got energy out.
    user_min_j: f64,
}

impl PortEnergy {
    /// Adds a tick in which the motors did work on the device and the device dissipated energy, J.
    pub(super) fn add(&mut self, motors_j: f64, loss_j: f64) {
        self.wall_j -= motors_j;
        self.throughput_j += motors_j.abs();
        self.loss_j += loss_j;
        self.user_min_j = self.user_min_j.min(self.wall_j + self.loss_j);
    }

    /// Most energy that the user got out beyond what they had put in, J; 0 within the rounding of the sums, as on one axis.
    #[must_use]
    pub fn out_j(&self) -> f64 {
        let tolerance = 1e-12 + 1e-6 * self.throughput_j;
        if self.user_min_j < -tolerance {
            -self.user_min_j
        } else {
            0.0
        }
    }
}
