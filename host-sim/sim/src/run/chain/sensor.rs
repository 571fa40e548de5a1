//! How the law comes to know the angle.

use crate::run::wall::Wall;

/// Gives the law the device's position.
pub trait Sensor {
    /// Lets the wall read the angle; gives its force, N·m out of the wall.
    fn read<W: Wall>(&self, wall: &mut W, angle_rad: f64) -> f64;
    /// Gives the wall the angle at which the motor's torque changed.
    fn tell_change<W: Wall>(&self, wall: &mut W, angle_rad: f64);
    /// The penetration that the wall gets at an angle, rad.
    fn told_rad(&self, angle_rad: f64) -> f64;
}

/// No encoder: the exact angle.
#[derive(Debug, Clone, Copy)]
pub struct ExactAngle {
    /// `x_s`, rad.
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

/// The exact angle from zero, not from a surface, for scenes with several walls.
#[derive(Debug, Clone, Copy)]
pub struct ExactPlace {
    /// `x_s` of the first wall, rad, from which a record counts.
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

impl Counts {
    /// A sensor with counts of this width, rad, and a surface.
    #[must_use]
    pub fn of(step_rad: f64, surface_rad: f64) -> Self {
        Self {
            per_rad: 1.0 / step_rad,
            step_rad,
            surface_rad,
        }
    }

    /// The nearest count.
    #[inline(always)]
    fn count(&self, angle_rad: f64) -> i64 {
        let scaled = angle_rad * self.per_rad;
        // By adding half and flooring, without the library call that `round` is on plain x86-64.
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
