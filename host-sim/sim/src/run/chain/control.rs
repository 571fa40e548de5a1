//! The law's side of the loop: from the true angle to the motor's torque, behind one call.

use super::sensor::Sensor;
use crate::run::wall::{Inside, Wall};

/// Everything between the true angle and the torque of the motor. One call of either method a tick.
pub trait Control {
    /// Torque of the motor along `+x`, N·m, at a true angle, rad.
    fn torque_n_m(&mut self, angle_rad: f64) -> f64;
    /// Same as `torque`, bit for bit, with the details that a recording needs.
    fn answer(&mut self, angle_rad: f64) -> Answer;
    /// What became of the last torque, N·m along `+x`, where an effect changed it.
    fn commanded(&mut self, torque_n_m: f64);
    /// The true angle at which the motor's torque changed since the last sample, rad.
    fn changed_at(&mut self, angle_rad: f64);
}

/// A torque, and how the law came to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// Torque of the motor along `+x`, N·m.
    pub torque_n_m: f64,
    /// Force of the law, out of the wall, N·m.
    pub force_n_m: f64,
    /// Penetration that the law got, rad.
    pub told_rad: f64,
    /// The law's inside after the tick.
    pub inside: Inside,
}

/// The innermost part: a law that gets the angle from a sensor. An ideal motor plays its force.
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
