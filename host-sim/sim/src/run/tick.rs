//! One tick of the loop, and the trait of its recorders.

use super::wall::Inside;

/// One tick of the loop. Angles and velocities are true values at the sample with which the tick starts, unless a field says
/// otherwise.
#[derive(Debug, Clone, Copy)]
pub struct Tick {
    /// Number of the tick, from 0.
    pub index: u64,
    /// Time of the sample, s.
    pub time_s: f64,
    /// Angle of the device, rad.
    pub angle_rad: f64,
    /// Velocity of the device, rad/s.
    pub velocity_rad_per_s: f64,
    /// Angle of the device at the end of the tick, rad.
    pub angle_after_rad: f64,
    /// Velocity of the device at the end of the tick, rad/s.
    pub velocity_after_rad_per_s: f64,
    /// Angle of the hand's mass, rad; the device's own where there is no hand.
    pub hand_rad: f64,
    /// The hand's rest point, rad.
    pub rest_rad: f64,
    /// Penetration that the law received from the sensor, rad.
    pub told_rad: f64,
    /// Force of the law, N·m, positive out of the wall.
    pub force_n_m: f64,
    /// Mean force of the motor over the tick, after limits, steps and delay, N·m, positive out of the wall.
    pub motor_force_n_m: f64,
    /// Energy that the wall's port absorbed in this tick, J; negative where it gave energy.
    pub absorbed_j: f64,
    /// Energy dissipated in the device in this tick, J.
    pub device_loss_j: f64,
    /// Energy that springs, gravity and magnets of the device gained in this tick, J; the kinetic energy of the whole inertia is
    /// not included.
    pub stored_j: f64,
    /// Internal values of the law after the tick.
    pub inside: Inside,
}

/// A recorder, which gets every tick.
pub trait Recorder {
    /// Records one tick. The ticks come in order.
    fn record(&mut self, tick: &Tick);
}

/// Ticks between two progress messages.
const TOLD_EVERY: u64 = 1024;

/// A recorder that also reports the number of finished ticks as progress.
pub(super) struct Told<'a, R> {
    pub inner: R,
    pub done: &'a mut dyn FnMut(u64),
}

impl<R: Recorder> Recorder for Told<'_, R> {
    fn record(&mut self, tick: &Tick) {
        if tick.index.is_multiple_of(TOLD_EVERY) {
            (self.done)(tick.index);
        }
        self.inner.record(tick);
    }
}
