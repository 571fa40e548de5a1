//! Carries a torque command from the controller to the plant, with its delay, and advances the plant by one tick (control period).

use std::collections::VecDeque;
use touchstone_world::plant::{Kinematics, Stepper};

/// Energies exchanged in one tick (control period): work of the motor, losses and storage in the device.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Flow {
    /// Mean torque of the motor in the direction of positive angles over the tick, N·m.
    pub torque_n_m: f64,
    /// Work of the motor on the device, J: the sum of torque times displacement over the parts of the tick. It is exact, because
    /// the torque is constant over each part.
    pub motor_j: f64,
    /// Energy dissipated in the device, J.
    pub device_loss_j: f64,
    /// Energy that the device stored in springs, gravity and magnets, J; kinetic energy is not included.
    pub stored_j: f64,
}

/// Carries a torque command through delays to the plant, and advances the plant by one tick.
pub trait Crossing: Send {
    /// State of the plant.
    type State: Kinematics;

    /// Advances plant and delayed commands by one tick (control period). `torque_n_m` is the new command in N·m, `rest_rad` the
    /// rest point of the hand in rad.
    fn cross(&mut self, state: &mut Self::State, torque_n_m: f64, rest_rad: f64);

    /// Does the same as `cross`, bit for bit, and returns the energies of the tick.
    fn cross_with_flow(&mut self, state: &mut Self::State, torque_n_m: f64, rest_rad: f64) -> Flow;

    /// Angle of the device at which the motor's torque changed in the last tick, rad; `None` if that angle is not measured.
    #[inline(always)]
    fn changed_at_rad(&self) -> Option<f64> {
        None
    }
}

#[inline(always)]
pub(super) fn step_with_flow<S: Stepper>(
    plant: &S,
    state: &mut S::State,
    torque_n_m: f64,
    rest_rad: f64,
) -> Flow {
    let port = plant.step_with_port(state, torque_n_m, rest_rad);
    Flow {
        torque_n_m: port.force,
        motor_j: port.work_j,
        device_loss_j: port.loss.device_j,
        stored_j: port.stored_j,
    }
}

/// No delay: the torque command of a tick acts during the whole tick.
#[derive(Debug, Clone, Copy)]
pub struct Prompt<S>(
    /// The stepper, which advances the plant by one control period.
    pub S,
);

impl<S: Stepper> Crossing for Prompt<S> {
    type State = S::State;

    #[inline(always)]
    fn cross(&mut self, state: &mut S::State, torque_n_m: f64, rest_rad: f64) {
        self.0.step(state, torque_n_m, rest_rad);
    }

    #[inline(always)]
    fn cross_with_flow(&mut self, state: &mut S::State, torque_n_m: f64, rest_rad: f64) -> Flow {
        step_with_flow(&self.0, state, torque_n_m, rest_rad)
    }
}

/// Calls any other type of crossing (with delay, jitter or tremor) indirectly, so that the loop is not compiled again for each.
impl<S: Kinematics> Crossing for Box<dyn Crossing<State = S>> {
    type State = S;

    #[inline(always)]
    fn cross(&mut self, state: &mut S, torque_n_m: f64, rest_rad: f64) {
        (**self).cross(state, torque_n_m, rest_rad);
    }

    #[inline(always)]
    fn cross_with_flow(&mut self, state: &mut S, torque_n_m: f64, rest_rad: f64) -> Flow {
        (**self).cross_with_flow(state, torque_n_m, rest_rad)
    }

    #[inline(always)]
    fn changed_at_rad(&self) -> Option<f64> {
        (**self).changed_at_rad()
    }
}

/// A computational delay of whole ticks and a fraction of a tick. The command changes once within each tick; one stepper advances
/// the plant before the change, another after it.
#[derive(Debug, Clone)]
pub struct Delayed<S> {
    /// Advances the plant over the first part of the tick, while the older command still acts.
    before: S,
    /// Advances the plant over the rest of the tick, under the newer command.
    after: S,
    /// Delayed torque commands, the oldest first; the first of them acts now.
    queue: VecDeque<f64>,
    /// Angle of the device when the motor's torque changed, rad; `None` if that angle is not measured.
    changed_at_rad: Option<f64>,
}

impl<S: Stepper> Delayed<S> {
    /// Builds a delay of `whole` control periods plus the time over which `before` advances the plant.
    pub fn new(before: S, after: S, whole: usize) -> Self {
        // Until the first command takes effect, the motor has no torque.
        Self {
            before,
            after,
            queue: VecDeque::from(vec![0.0; whole + 1]),
            changed_at_rad: None,
        }
    }

    /// Makes the delay also measure the angle of the device when the torque changes.
    #[must_use]
    pub fn measured(self, start_rad: f64) -> Self {
        Self {
            changed_at_rad: Some(start_rad),
            ..self
        }
    }

    /// Records the angle at which the torque command changed. With a delay below one tick, that is the angle at the change within
    /// this tick; with a delay of one tick or more, the angle at the tick's end is taken.
    #[inline(always)]
    fn take_down(&mut self, at_change_rad: f64, at_end_rad: f64) {
        if let Some(changed) = &mut self.changed_at_rad {
            let whole = self.queue.len() > 1;
            *changed = if whole { at_end_rad } else { at_change_rad };
        }
    }

    /// Torques that act before and after the command changes in this tick, N·m.
    #[inline(always)]
    fn commands(&mut self, torque_n_m: f64) -> (f64, f64) {
        self.queue.push_back(torque_n_m);
        let old = self.queue.pop_front().unwrap_or(0.0);
        (old, self.queue.front().copied().unwrap_or(torque_n_m))
    }
}

impl<S: Stepper> Crossing for Delayed<S> {
    type State = S::State;

    fn cross(&mut self, state: &mut S::State, torque_n_m: f64, rest_rad: f64) {
        let (old, new) = self.commands(torque_n_m);
        self.before.step(state, old, rest_rad);
        let at_change_rad = state.position();
        self.after.step(state, new, rest_rad);
        self.take_down(at_change_rad, state.position());
    }

    fn cross_with_flow(&mut self, state: &mut S::State, torque_n_m: f64, rest_rad: f64) -> Flow {
        let (old, new) = self.commands(torque_n_m);
        let first = step_with_flow(&self.before, state, old, rest_rad);
        let at_change_rad = state.position();
        let second = step_with_flow(&self.after, state, new, rest_rad);
        self.take_down(at_change_rad, state.position());
        let (early_s, late_s) = (self.before.interval_s(), self.after.interval_s());
        Flow {
            torque_n_m: (first.torque_n_m * early_s + second.torque_n_m * late_s)
                / (early_s + late_s),
            motor_j: first.motor_j + second.motor_j,
            device_loss_j: first.device_loss_j + second.device_loss_j,
            stored_j: first.stored_j + second.stored_j,
        }
    }

    fn changed_at_rad(&self) -> Option<f64> {
        self.changed_at_rad
    }
}
