//! One tick of the loop, and the trait of its recorders.

use super::wall::Inside;

/// One tick as the loop saw it. Angles and velocities are true, and those of the sample unless they say otherwise.
#[derive(Debug, Clone, Copy)]
pub struct Tick {
    /// Index from 0.
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
    /// Penetration that the law got, rad.
    pub told_rad: f64,
    /// Force of the law, pushing out, N·m.
    pub force_n_m: f64,
    /// Force of the motor, pushing out, its mean over the tick, N·m: after limits, steps and delay.
    pub motor_force_n_m: f64,
    /// Work of the wall's port in this tick, J, positive = absorbed.
    pub absorbed_j: f64,
    /// Dissipated in the device in this tick, J.
    pub device_loss_j: f64,
    /// Gained by the device in this tick otherwise than by the motion of its whole inertia, J: by springs, gravity, magnets.
    pub stored_j: f64,
    /// The law's inside after the tick.
    pub inside: Inside,
}

/// A recorder, which gets every tick.
pub trait Recorder {
    /// Takes down a tick; they come in order.
    fn record(&mut self, tick: &Tick);
}

/// Ticks between two words of how far a run is.
const TOLD_EVERY: u64 = 1024;

/// A recorder beside which somebody is told how many ticks are done.
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
