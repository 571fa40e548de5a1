//! The interface of every plant: advance by one interval.

use super::state::Kinematics;

/// A plant prepared for intervals of one fixed length. Torque and rest point of the hand are held during each interval.
pub trait Stepper {
    /// The plant's state.
    type State: Kinematics;

    /// Length of the interval, s.
    fn interval_s(&self) -> f64;

    /// Advances by one interval.
    ///
    /// `force` acts on the device in the direction of positive `x`; `rest` is the hand's rest point (not used without a hand).
    fn step(&self, state: &mut Self::State, force: f64, rest: f64);

    /// Same as [`Stepper::step`], bit for bit. Also returns the dissipated energy.
    fn step_with_loss(&self, state: &mut Self::State, force: f64, rest: f64) -> Loss;

    /// Same as [`Stepper::step_with_loss`]. Also returns the motor's work and the change of the energy stored in the device.
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

    /// Kinetic energy and energy of the springs of device and hand, J.
    ///
    /// The energy balance of a step is `u (x' - x) = stored' - stored + loss`, with the same `rest` in `stored'` and `stored`. A
    /// jump of the rest point between two steps does the work `stored(new rest) - stored(old rest)` on the hand's spring.
    fn stored_energy_j(&self, state: &Self::State, rest: f64) -> f64;
}

/// A [`Stepper`] whose step is linear in state, torque and rest point.
pub trait LinearStepper: Stepper {}

/// Energy dissipated during one interval, J. Neither field is negative beyond rounding.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Loss {
    /// Energy dissipated in the device by viscous damping and dry friction, `b ∫v² dt + F_k ∫|v| dt`.
    pub device_j: f64,
    /// Energy dissipated in the hand by its damper and the pad, `b_h ∫v_h² dt + b_p ∫(v - v_h)² dt`; zero without a hand.
    pub hand_j: f64,
}

/// The energies of one interval at the motor and in the device.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Port {
    /// Mean of the motor's torque over the interval in the direction of positive `x`, N·m.
    pub force: f64,
    /// The motor's work on the device, J.
    pub work_j: f64,
    /// Dissipated energy.
    pub loss: Loss,
    /// Change of the energy of springs, gravity and magnets in the device, J. The kinetic energy is not included.
    pub stored_j: f64,
}

impl Loss {
    /// Sum of the losses, J.
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
