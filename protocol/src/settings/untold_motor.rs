//! The first settings of a device without current sensors: supply and limits of the small gimbal knob, but no motor.
//!
//! Such a device makes torque by voltage, calculated from resistance and torque constant, so these two must not be guessed.
//! Resistance, torque constant and inductance have the smallest values of their ranges, which mean "not set". A calibration
//! refuses these values; no motor for this board has them. The wall's control law is that of the scene file
//! `scenes/voltage-knob.toml` (a test compares both). The law's force limit depends on the torque constant, so the user has to
//! set it as well.

use super::gimbal_kit::{self, set};
use super::{DeviceSettings, fields};
use touchstone_control::Si;

/// Gives the smallest allowed value of a motor setting, which means "not set".
macro_rules! untold {
    ($path:literal) => {
        const { fields::range($path).0 }
    };
}

impl DeviceSettings {
    /// The path of the first motor setting that the user has not set; `None` if all are set. Without current sensors the device can
    /// neither measure these settings nor compare them with anything.
    #[must_use]
    pub fn untold_motor(&self) -> Option<&'static str> {
        let motor = &self.motor;
        [
            (
                "motor.resistance_ohm",
                motor.resistance_ohm,
                untold!("motor.resistance_ohm"),
            ),
            (
                "motor.inductance_h",
                motor.inductance_h,
                untold!("motor.inductance_h"),
            ),
            (
                "motor.torque_constant_n_m_per_a",
                motor.torque_constant_n_m_per_a,
                untold!("motor.torque_constant_n_m_per_a"),
            ),
        ]
        .into_iter()
        .find_map(|(path, value, least)| (value <= least).then_some(path))
    }
}

/// Sets supply, limits and control law, and marks the motor as not set.
pub(super) fn fit(settings: &mut DeviceSettings) {
    gimbal_kit::fit(settings);
    settings.motor.resistance_ohm = untold!("motor.resistance_ohm");
    settings.motor.inductance_h = untold!("motor.inductance_h");
    settings.motor.torque_constant_n_m_per_a = untold!("motor.torque_constant_n_m_per_a");
    set! { settings:
        law.force_limit_n_m = "0.0007";
        law.limit_of_force_per_ms = "0.3322";
        law.limit_of_penetration_per_ms = "0.5238";
        law.step_of_ideal_per_ms = "0.1692";
        law.filter.damping_n_m_s_per_rad = "0.009071";
        law.filter.ground_damping_n_m_s_per_rad = "0.00125";
        law.filter.mass_kg_m2 = "0.0000009235";
        law.filter.stiffness_n_m_per_rad = "23.97";
    }
}
