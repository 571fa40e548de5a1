//! The interface of every plant: advance by one interval.

use super::state::Kinematics;

/// A plant prepared for intervals of one fixed length, during which torque and rest point of the hand are constant.
pub trait Stepper: Send {
    /// The plant's state.
    type State: Kinematics;

    /// Length of the interval, s.
    fn interval_s(&self) -> f64;

    /// Advances by one interval.
    ///
    /// `force` acts on the device in the direction of positive `x`; `rest` is the hand's rest point (not used without a hand).
    fn step(&self, state: &mut Self::State, force: f64, rest: f64);

    /// Advances the same as [`Stepper::step`], bit for bit, and returns the dissipated energy.
    fn step_with_loss(&self, state: &mut Self::State, force: f64, rest: f64) -> Loss;

    /// Advances the same as [`Stepper::step_with_loss`], and also returns the motor's work and the change of the energy stored in
    /// the device.
    #[inline(always)]
    fn step_with_port(&self, state: &mut Self::State, force: f64, rest: f64) -> Port {
        let before = state.position();
        let loss = self.step_with_loss(state, force, rest);
        Port {
            force,
            work_j: force * (state.position() - before),
            loss,
            stored_j: 0.0,
        }
    }

    /// Kinetic energy and energy of the springs of device and hand, J. `rest` is the hand's rest point.
    ///
    /// The energy balance of a step from `x` to `x'` under the torque `u` is `u (x' - x) = stored' - stored + loss`, with the same
    /// `rest` in `stored'` and `stored`. A jump of the rest point between two steps does the work `stored(new rest) - stored(old
    /// rest)` on the hand's spring.
    fn stored_energy_j(&self, state: &Self::State, rest: f64) -> f64;
}

/// A [`Stepper`] whose step is a linear function of state, torque and rest point.
pub trait LinearStepper: Stepper {}

/// Energy dissipated during one interval, J. Neither field is negative beyond rounding.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Loss {
    /// Energy dissipated in the device, `b ∫v² dt + F_k ∫|v| dt`: viscous damping `b`, dry friction `F_k` in motion, velocity `v`.
    pub device_j: f64,
    /// Energy dissipated in the hand, `b_h ∫v_h² dt + b_p ∫(v - v_h)² dt`; zero without a hand. `b_h` and `b_p` are the damping of
    /// hand and fingertip pad, `v_h` and `v` the velocities of hand and device.
    pub hand_j: f64,
}

/// Energies of one interval: work of the motor, losses, and change of the energy stored in the device.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Port {
    /// Mean of the motor's torque over the interval in the direction of positive `x`, N·m.
    pub force: f64,
    /// The motor's work on the device, J.
    pub work_j: f64,
    /// Energy dissipated in device and hand.
    pub loss: Loss,
    /// Change of the energy stored in springs, gravity and magnets of the device, J. The kinetic energy is not included.
    pub stored_j: f64,
}

impl Loss {
    /// Energy dissipated in device and hand together, J.
    #[must_use]
    pub fn total_j(&self) -> f64 {
        self.device_j + self.hand_j
    }
}

impl std::ops::AddAssign for Loss {
    fn add_assign(&mut self, other: Self) {
        self.device_j += other.device_j;
        self.hand_j += other.hand_j;
    }
}
