//! Rounding errors of forces, stiffnesses and energies in each number format, from which tests derive their error bounds.

use touchstone_control::{Fixed16, Fixed32, Reported};

/// Rounding errors of a number format, for forces of at most 0.5 N·m.
pub trait Grain: Reported {
    /// Largest rounding error of a force, N·m: one step where the format truncates, half a step where it rounds to nearest.
    const FORCE_N_M: f64;
    /// Largest rounding error of a stiffness that a control law calculates, N·m/rad.
    const GAIN_N_M_PER_RAD: f64;
    /// Largest relative rounding error of one sum or product of energies; 0 for the fixed-point formats.
    const ENERGY: f64;
    /// Number of fractional bits of a grid of angles. Both this format and `Fixed32` represent every grid point below 0.5 rad
    /// exactly.
    const ANGLE_BITS: i32;
}

impl Grain for Fixed16 {
    const FORCE_N_M: f64 = 1.0 / 16_384.0;
    const GAIN_N_M_PER_RAD: f64 = 1.0 / 64.0;
    const ENERGY: f64 = 0.0;
    const ANGLE_BITS: i32 = 14;
}

impl Grain for Fixed32 {
    const FORCE_N_M: f64 = 1.0 / 16_777_216.0;
    const GAIN_N_M_PER_RAD: f64 = 1.0 / 4_096.0;
    const ENERGY: f64 = 0.0;
    const ANGLE_BITS: i32 = 24;
}

impl Grain for f32 {
    // Half the distance of neighbouring numbers below 0.5, and as much again for the product, which is rounded before the sum.
    const FORCE_N_M: f64 = 1.0 / 33_554_432.0;
    const GAIN_N_M_PER_RAD: f64 = f32::EPSILON as f64;
    const ENERGY: f64 = f32::EPSILON as f64;
    const ANGLE_BITS: i32 = 24;
}

impl Grain for f64 {
    const FORCE_N_M: f64 = f64::EPSILON;
    const GAIN_N_M_PER_RAD: f64 = f64::EPSILON;
    const ENERGY: f64 = f64::EPSILON;
    const ANGLE_BITS: i32 = 24;
}
