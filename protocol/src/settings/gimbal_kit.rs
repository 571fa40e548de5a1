//! The first settings of a device with the small gimbal motor GBM2804H-100T, which is sold in a kit with the X-NUCLEO-IHM16M1. The
//! scene `scenes/gimbal-knob.toml` simulates its knob with the same control law (a test compares both).
//!
//! | number | source |
//! |---|---|
//! | 7 pole pairs, 5.29 Ω, 1.05 mH | NuttX's table of motors |
//! | 6 Ω in the loop | the motor's, half of the driver's 1 Ω, and half of the shunt's 0.33 Ω |
//! | 0.0565 N·m/A | a flux linkage of 5.38 mWb, which others measured on three of these motors |
//! | 0.8 A | the motor's rated current, in a sample export of the vendor's tools |
//! | 0.5 A continuous, 20 s | our assumption: 2 W in the windings; no data sheet was read |
//! | 10 to 16 V | our choice: the kit's 12 V, and what a braked knob may feed back |
//! | the law | `touchstone tune gimbal-knob`; wall, damper and estimator by `touchstone scorecard --family`: none of 216 simulated device variants loses the wall at 1 and 2 N·m/rad |

use super::DeviceSettings;
use touchstone_control::Si;

macro_rules! set {
    ($settings:ident: $($($field:ident).+ = $value:literal;)+) => {
        $($settings.$($field).+ = const { Si::lit($value) };)+
    };
}

pub(super) use set;

/// Sets motor, supply, limits and control law to those of the motor kit.
pub(super) fn fit(settings: &mut DeviceSettings) {
    set! { settings:
        motor.resistance_ohm = "6";
        motor.inductance_h = "0.00105";
        motor.torque_constant_n_m_per_a = "0.0565";
        motor.current_limit_a = "0.8";
        motor.continuous_current_a = "0.5";
        limits.trip_current_a = "1.6";
        limits.bus_min_v = "10";
        limits.bus_max_v = "16";
        calibration.current_a = "0.5";
        wall.k_desired_n_m_per_rad = "2";
        law.force_limit_n_m = "0.045";
        law.k_soft_n_m_per_rad = "6.1";
        law.virtual_damping_n_m_s_per_rad = "0.0058";
        law.limit_of_force_per_ms = "0.3529";
        law.limit_of_penetration_per_ms = "0.6765";
        law.step_of_ideal_per_ms = "0.3435";
        law.estimator.bandwidth_hz = "71";
        law.estimator.damping_n_m_s_per_rad = "0.000009";
        law.estimator.delay_s = "0.0009";
        law.estimator.inertia_kg_m2 = "0.0000195";
        law.filter.damping_n_m_s_per_rad = "0.002704";
        law.filter.ground_damping_n_m_s_per_rad = "0.002728";
        law.filter.mass_kg_m2 = "0.0000002345";
        law.filter.stiffness_n_m_per_rad = "11.69";
        law.guard.damping_n_m_s_per_rad = "0.000009";
        law.guard.refill_w = "0.00059";
    }
}
