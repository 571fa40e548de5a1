//! The motor's values that a person enters in the settings of a board that cannot measure them.

use touchstone_control::Si;
use touchstone_protocol::settings::DeviceSettings;

/// Values of a motor as a person enters them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ToldMotor {
    /// Resistance between a phase and the star point, including the driver's transistor, Ω.
    pub resistance_ohm: Si,
    /// Inductance between a phase and the star point, H.
    pub inductance_h: Si,
    /// Torque in N·m per ampere of current amplitude.
    pub torque_constant_n_m_per_a: Si,
    /// The wall's force limit, N·m.
    pub force_limit_n_m: Si,
}

impl ToldMotor {
    /// The motor GBM2804H-100T, with the resistance of a transistor of the DRV8313 added.
    pub const GIMBAL: Self = Self {
        resistance_ohm: Si::lit("5.53"),
        inductance_h: Si::lit("0.00105"),
        torque_constant_n_m_per_a: Si::lit("0.0565"),
        force_limit_n_m: Si::lit("0.045"),
    };

    /// Writes the motor's values into the settings.
    pub fn tell(&self, settings: &mut DeviceSettings) {
        settings.motor.resistance_ohm = self.resistance_ohm;
        settings.motor.inductance_h = self.inductance_h;
        settings.motor.torque_constant_n_m_per_a = self.torque_constant_n_m_per_a;
        settings.law.force_limit_n_m = self.force_limit_n_m;
    }
}
