//! Once-per-tick effects between law and plant: encoder, torque limit, amplifier steps, computational delay.
//!
//! Each is a type; the plan picks the types that a scene names and the loop is compiled for them. What a scene does not name
//! is not in the loop: not computed, not stored, not branched on.

use super::wall::Wall;
use std::collections::VecDeque;
use touchstone_world::plant::Stepper;

/// How the law comes to know the angle.
pub trait Sensor {
    /// Lets the wall read the angle; returns its force and the penetration that it was told, rad.
    fn read(&self, wall: &mut dyn Wall, angle_rad: f64) -> (f64, f64);
}

/// No encoder: the exact angle.
#[derive(Debug, Clone, Copy)]
pub struct ExactAngle {
    /// `x_s`, rad.
    pub surface_rad: f64,
}

impl Sensor for ExactAngle {
    #[inline(always)]
    fn read(&self, wall: &mut dyn Wall, angle_rad: f64) -> (f64, f64) {
        let e = angle_rad - self.surface_rad;
        (wall.at_penetration(e), e)
    }
}

/// An encoder: the nearest count.
#[derive(Debug, Clone, Copy)]
pub struct Counts {
    /// Counts per radian.
    pub per_rad: f64,
    /// Radians per count.
    pub step_rad: f64,
    /// `x_s`, rad.
    pub surface_rad: f64,
}

impl Sensor for Counts {
    #[inline(always)]
    fn read(&self, wall: &mut dyn Wall, angle_rad: f64) -> (f64, f64) {
        let scaled = angle_rad * self.per_rad;
        // The nearest count by adding half and flooring, without the library call that `round` is on plain x86-64.
        let shifted = scaled + 0.5;
        let cut = shifted as i64;
        let count = cut - i64::from((cut as f64) > shifted);
        (
            wall.at_count(count),
            count as f64 * self.step_rad - self.surface_rad,
        )
    }
}

/// What becomes of a torque command on its way to the motor.
pub trait Amplifier {
    /// Torque that acts, N·m, for the one that was commanded.
    fn torque(&self, command_n_m: f64) -> f64;
}

/// The ideal motor.
#[derive(Debug, Clone, Copy)]
pub struct Ideal;

impl Amplifier for Ideal {
    #[inline(always)]
    fn torque(&self, command_n_m: f64) -> f64 {
        command_n_m
    }
}

/// A largest torque.
#[derive(Debug, Clone, Copy)]
pub struct Limited<A> {
    /// What comes before it.
    pub inner: A,
    /// Largest torque, N·m.
    pub limit_n_m: f64,
}

impl<A: Amplifier> Amplifier for Limited<A> {
    #[inline(always)]
    fn torque(&self, command_n_m: f64) -> f64 {
        self.inner
            .torque(command_n_m)
            .clamp(-self.limit_n_m, self.limit_n_m)
    }
}

/// A smallest step, rounded to the nearest.
#[derive(Debug, Clone, Copy)]
pub struct Stepped<A> {
    /// What comes before it.
    pub inner: A,
    /// Step, N·m.
    pub step_n_m: f64,
}

impl<A: Amplifier> Amplifier for Stepped<A> {
    #[inline(always)]
    fn torque(&self, command_n_m: f64) -> f64 {
        (self.inner.torque(command_n_m) / self.step_n_m).round() * self.step_n_m
    }
}

/// What one tick did at the wall's port and in the device, J.
#[derive(Debug, Clone, Copy, Default)]
pub struct Flow {
    /// Work of the motor on the device: `Σ u Δx` over the parts of the tick, exact under the zero-order hold.
    pub motor_j: f64,
    /// Dissipated in the device; only computed by [`Crossing::cross_with_loss`].
    pub device_loss_j: f64,
}

/// How a torque command meets the plant over one tick.
pub trait Crossing {
    /// The plant behind it.
    type Plant: Stepper;

    /// Crosses one tick; says what the motor did.
    fn cross(
        &mut self,
        state: &mut <Self::Plant as Stepper>::State,
        torque_n_m: f64,
        rest_rad: f64,
    ) -> Flow;

    /// The same to the bit, with the loss in the device.
    fn cross_with_loss(
        &mut self,
        state: &mut <Self::Plant as Stepper>::State,
        torque_n_m: f64,
        rest_rad: f64,
    ) -> Flow;
}

use touchstone_world::plant::Motion;

#[inline(always)]
fn plain<S: Stepper>(plant: &S, state: &mut S::State, torque_n_m: f64, rest_rad: f64) -> Flow {
    let before = state.position();
    plant.step(state, torque_n_m, rest_rad);
    Flow {
        motor_j: torque_n_m * (state.position() - before),
        device_loss_j: 0.0,
    }
}

#[inline(always)]
fn with_loss<S: Stepper>(plant: &S, state: &mut S::State, torque_n_m: f64, rest_rad: f64) -> Flow {
    let before = state.position();
    let loss = plant.step_with_loss(state, torque_n_m, rest_rad);
    Flow {
        motor_j: torque_n_m * (state.position() - before),
        device_loss_j: loss.device_j,
    }
}

/// No delay: the command of a tick acts during that tick.
#[derive(Debug, Clone, Copy)]
pub struct Prompt<S>(
    /// The plant over one period.
    pub S,
);

impl<S: Stepper> Crossing for Prompt<S> {
    type Plant = S;

    #[inline(always)]
    fn cross(&mut self, state: &mut S::State, torque_n_m: f64, rest_rad: f64) -> Flow {
        plain(&self.0, state, torque_n_m, rest_rad)
    }

    #[inline(always)]
    fn cross_with_loss(&mut self, state: &mut S::State, torque_n_m: f64, rest_rad: f64) -> Flow {
        with_loss(&self.0, state, torque_n_m, rest_rad)
    }
}

/// A computational delay of whole ticks and a fraction: two plants take turns on one state.
#[derive(Debug, Clone)]
pub struct Delayed<S> {
    /// The plant over the fraction, while the older command still acts.
    before: S,
    /// The plant over the rest of the period.
    after: S,
    /// Commands on their way, the oldest first; the first of them acts now.
    queue: VecDeque<f64>,
}

impl<S: Stepper> Delayed<S> {
    /// A delay of `whole` periods and the length of `before`.
    pub fn new(before: S, after: S, whole: usize) -> Self {
        // Before the first command arrives the motor is off.
        Self {
            before,
            after,
            queue: VecDeque::from(vec![0.0; whole + 1]),
        }
    }

    /// The commands of the two parts of this tick.
    #[inline(always)]
    fn commands(&mut self, torque_n_m: f64) -> (f64, f64) {
        self.queue.push_back(torque_n_m);
        let old = self.queue.pop_front().unwrap_or(0.0);
        (old, self.queue.front().copied().unwrap_or(torque_n_m))
    }
}

impl<S: Stepper> Crossing for Delayed<S> {
    type Plant = S;

    #[inline(always)]
    fn cross(&mut self, state: &mut S::State, torque_n_m: f64, rest_rad: f64) -> Flow {
        let (old, new) = self.commands(torque_n_m);
        let first = plain(&self.before, state, old, rest_rad);
        let second = plain(&self.after, state, new, rest_rad);
        Flow {
            motor_j: first.motor_j + second.motor_j,
            device_loss_j: 0.0,
        }
    }

    #[inline(always)]
    fn cross_with_loss(&mut self, state: &mut S::State, torque_n_m: f64, rest_rad: f64) -> Flow {
        let (old, new) = self.commands(torque_n_m);
        let first = with_loss(&self.before, state, old, rest_rad);
        let second = with_loss(&self.after, state, new, rest_rad);
        Flow {
            motor_j: first.motor_j + second.motor_j,
            device_loss_j: first.device_loss_j + second.device_loss_j,
        }
    }
}
