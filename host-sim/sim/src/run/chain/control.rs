//! The controller side of the loop: everything from the true angle to the motor's torque, behind one call.

use super::sensor::Sensor;
use crate::run::wall::{Inside, Wall};

/// Everything between the true angle and the torque of the motor. The loop calls `torque_n_m` or `answer` once a tick.
pub trait Control {
    /// Torque of the motor along `+x` in N·m, at a true angle in rad.
    fn torque_n_m(&mut self, angle_rad: f64) -> f64;
    /// Same as `torque_n_m`, bit for bit, with the details that a recording needs.
    fn answer(&mut self, angle_rad: f64) -> Answer;
    /// Reports the torque that was really commanded, N·m along `+x`, after an effect (such as a limit) changed the last torque.
    fn commanded(&mut self, torque_n_m: f64);
    /// Reports the true angle at which the motor's torque changed since the last sample, rad.
    fn changed_at(&mut self, angle_rad: f64);
}

/// A torque, with the values of the law that led to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// Torque of the motor along `+x`, N·m.
    pub torque_n_m: f64,
    /// Force of the law, N·m, positive out of the wall.
    pub force_n_m: f64,
    /// Penetration that the law received from the sensor, rad.
    pub told_rad: f64,
    /// Internal values of the law after the tick.
    pub inside: Inside,
}

/// Innermost part of the controller side: a law that gets its angle from a sensor, with an ideal motor.
#[derive(Debug, Clone, Copy)]
pub struct Sampled<S, W> {
    /// The sensor that gives the law the angle.
    pub sensor: S,
    /// The law at its surface.
    pub wall: W,
}

impl<S: Sensor, W: Wall> Control for Sampled<S, W> {
    // Reached through a table of functions in any case, and the law's code then stands in the program once.
    #[inline(never)]
    fn torque_n_m(&mut self, angle_rad: f64) -> f64 {
        // The wall pushes out, along -x.
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
