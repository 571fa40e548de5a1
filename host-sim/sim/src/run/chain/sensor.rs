//! Gives the control law the device's angle: exactly, or as encoder counts.

use crate::run::wall::Wall;

/// A position sensor: gives the control law the device's position.
pub trait Sensor: Send {
    /// Passes the device's angle to the wall, and returns the wall's force, N·m, positive out of the wall.
    fn read<W: Wall>(&self, wall: &mut W, angle_rad: f64) -> f64;
    /// Passes to the wall the device's angle at which the motor's torque changed, rad.
    fn tell_change<W: Wall>(&self, wall: &mut W, angle_rad: f64);
    /// Penetration that the wall receives for a true angle, rad.
    fn told_rad(&self, angle_rad: f64) -> f64;
}

/// Exact sensor: the control law receives the true angle, measured from the wall's surface.
#[derive(Debug, Clone, Copy)]
pub struct ExactAngle {
    /// Position `x_s` of the wall's surface, rad.
    pub surface_rad: f64,
}

impl Sensor for ExactAngle {
    #[inline(always)]
    fn read<W: Wall>(&self, wall: &mut W, angle_rad: f64) -> f64 {
        wall.at_penetration(self.told_rad(angle_rad))
    }

    fn tell_change<W: Wall>(&self, wall: &mut W, angle_rad: f64) {
        wall.changed_at_penetration(self.told_rad(angle_rad));
    }

    #[inline(always)]
    fn told_rad(&self, angle_rad: f64) -> f64 {
        angle_rad - self.surface_rad
    }
}

/// Exact sensor for scenes with several walls: the control law receives the true angle, measured from zero.
#[derive(Debug, Clone, Copy)]
pub struct ExactPlace {
    /// Position `x_s` of the first wall's surface, rad, from which records measure penetration.
    pub surface_rad: f64,
}

impl Sensor for ExactPlace {
    #[inline(always)]
    fn read<W: Wall>(&self, wall: &mut W, angle_rad: f64) -> f64 {
        wall.at_penetration(angle_rad)
    }

    fn tell_change<W: Wall>(&self, wall: &mut W, angle_rad: f64) {
        wall.changed_at_penetration(angle_rad);
    }

    #[inline(always)]
    fn told_rad(&self, angle_rad: f64) -> f64 {
        angle_rad - self.surface_rad
    }
}

/// Encoder: the control law receives the count nearest to the true angle.
#[derive(Debug, Clone, Copy)]
pub struct Counts {
    /// Encoder counts per radian.
    pub per_rad: f64,
    /// Angle of one encoder count, rad.
    pub step_rad: f64,
    /// Position `x_s` of the wall's surface, rad.
    pub surface_rad: f64,
}

impl Counts {
    /// Makes an encoder whose counts are `step_rad` apart, for a wall with its surface at `surface_rad`.
    #[must_use]
    pub fn of(step_rad: f64, surface_rad: f64) -> Self {
        Self {
            per_rad: 1.0 / step_rad,
            step_rad,
            surface_rad,
        }
    }

    /// Encoder count nearest to an angle in rad.
    #[inline(always)]
    fn count(&self, angle_rad: f64) -> i64 {
        let scaled = angle_rad * self.per_rad;
        // Adding half and flooring avoids `round`, which is a library call on plain x86-64.
        let shifted = scaled + 0.5;
        let cut = shifted as i64;
        cut.saturating_sub(i64::from((cut as f64) > shifted))
    }
}

impl Sensor for Counts {
    #[inline(always)]
    fn read<W: Wall>(&self, wall: &mut W, angle_rad: f64) -> f64 {
        wall.at_count(self.count(angle_rad))
    }

    fn tell_change<W: Wall>(&self, wall: &mut W, angle_rad: f64) {
        wall.changed_at_count(self.count(angle_rad));
    }

    #[inline(always)]
    fn told_rad(&self, angle_rad: f64) -> f64 {
        self.count(angle_rad) as f64 * self.step_rad - self.surface_rad
    }
}
