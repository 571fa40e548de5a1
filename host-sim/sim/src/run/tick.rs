//! Values of one tick (control period) of the simulation loop, and the trait of recorders that receive them.

use super::wall::Inside;

/// Values of one tick (control period) of the simulation loop. Angles and velocities are true values at the start of the tick,
/// unless a field says otherwise.
#[derive(Debug, Clone, Copy)]
pub struct Tick {
    /// Number of the tick (control period), from 0.
    pub index: u64,
    /// Time of the position sample with which the tick starts, s.
    pub time_s: f64,
    /// Angle of the device, rad.
    pub angle_rad: f64,
    /// Velocity of the device, rad/s.
    pub velocity_rad_per_s: f64,
    /// Angle of the device at the end of the tick, rad.
    pub angle_after_rad: f64,
    /// Velocity of the device at the end of the tick, rad/s.
    pub velocity_after_rad_per_s: f64,
    /// Angle of the hand's mass, rad; without a hand, the device's angle.
    pub hand_rad: f64,
    /// Rest point of the hand, rad: the angle to which the person pulls the hand.
    pub rest_rad: f64,
    /// Penetration that the control law received from the sensor, rad.
    pub told_rad: f64,
    /// Force of the control law, N·m, positive out of the wall.
    pub force_n_m: f64,
    /// Mean force of the motor over the tick, N·m, positive out of the wall, after torque limit, amplifier resolution and delay.
    pub motor_force_n_m: f64,
    /// Energy that the wall absorbed in this tick, J; negative if the wall gave energy to the device.
    pub absorbed_j: f64,
    /// Energy dissipated in the device in this tick, J.
    pub device_loss_j: f64,
    /// Energy that springs, gravity and magnets of the device gained in this tick, J. The kinetic energy of the device is not
    /// included.
    pub stored_j: f64,
    /// Internal values of the control law after the tick.
    pub inside: Inside,
}

/// A recorder, which receives the values of every tick (control period).
pub trait Recorder {
    /// Records one tick. The ticks come in order.
    fn record(&mut self, tick: &Tick);
}

/// Recorder that keeps only the last tick.
pub(super) struct Last(pub Option<Tick>);

impl Recorder for Last {
    fn record(&mut self, tick: &Tick) {
        self.0 = Some(*tick);
    }
}

/// Number of ticks between two progress messages.
const PROGRESS_EVERY: u64 = 1024;

/// A recorder that also reports the number of finished ticks as progress.
pub(super) struct WithProgress<'a, R> {
    pub inner: R,
    pub done: &'a mut dyn FnMut(u64),
}

impl<R: Recorder> Recorder for WithProgress<'_, R> {
    fn record(&mut self, tick: &Tick) {
        if tick.index.is_multiple_of(PROGRESS_EVERY) {
            (self.done)(tick.index);
        }
        self.inner.record(tick);
    }
}
