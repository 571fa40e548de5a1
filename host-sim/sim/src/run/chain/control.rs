//! The controller side of the loop, from the device's true angle to the motor's torque.

use super::sensor::Sensor;
use crate::run::wall::{Inside, Wall};

/// Computes the motor's torque from the device's true angle. The loop calls `torque_n_m` or `answer` once per tick (control
/// period).
pub trait Control: Send {
    /// Returns the torque of the motor in N·m, in the direction of positive angles, at a true angle in rad.
    fn torque_n_m(&mut self, angle_rad: f64) -> f64;
    /// Returns the same torque as `torque_n_m`, bit for bit, with internal values for a recording.
    fn answer(&mut self, angle_rad: f64) -> Answer;
    /// Reports the torque that was really commanded, N·m in the direction of positive angles, after a limit or another effect
    /// changed the torque of the control law.
    fn commanded(&mut self, torque_n_m: f64);
    /// Reports the true angle at the moment when the motor's torque last changed, rad.
    fn changed_at(&mut self, angle_rad: f64);
}

/// A motor torque, with the internal values of the control law that computed it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// Torque of the motor in the direction of positive angles, N·m.
    pub torque_n_m: f64,
    /// Force of the control law, N·m, positive out of the wall.
    pub force_n_m: f64,
    /// Penetration that the control law received from the sensor, rad.
    pub told_rad: f64,
    /// Internal values of the law after the tick.
    pub inside: Inside,
}

/// Basic controller side without further effects: a sensor that gives the angle, and a control law that gives the torque.
#[derive(Debug, Clone, Copy)]
pub struct Sampled<S, W> {
    /// The sensor that gives the law the angle.
    pub sensor: S,
    /// The control law at the surface of its wall.
    pub wall: W,
}

impl<S: Sensor, W: Wall + Send> Control for Sampled<S, W> {
    // The loop calls this method indirectly in any case. Without inlining, the law's code exists only once.
    #[inline(never)]
    fn torque_n_m(&mut self, angle_rad: f64) -> f64 {
        // The wall's force pushes out of the wall, in the direction of -x.
        -self.sensor.read(&mut self.wall, angle_rad)
    }

    fn answer(&mut self, angle_rad: f64) -> Answer {
        let torque_n_m = self.torque_n_m(angle_rad);
        Answer {
            torque_n_m,
            force_n_m: -torque_n_m,
            told_rad: self.sensor.told_rad(angle_rad),
            inside: self.wall.inside(),
        }
    }

    fn commanded(&mut self, torque_n_m: f64) {
        self.wall.commanded(-torque_n_m);
    }

    fn changed_at(&mut self, angle_rad: f64) {
        self.sensor.tell_change(&mut self.wall, angle_rad);
    }
}
