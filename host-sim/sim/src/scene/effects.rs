//! Effects that refine the basic model of device, sensors and hand, such as noise or cogging. An effect is simulated only if the
//! scene gives its table.
//!
//! A table without fields adds most effects at a typical magnitude; [`crate::run::effects::EFFECTS`] gives the source of each
//! default.

use serde::{Deserialize, Serialize};

/// Errors of the position sensor, in addition to the quantisation by the encoder.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SensorErrors {
    /// White noise of the position sensor. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub noise: Option<SensorNoise>,
    /// Angle error that repeats every turn. Absent: none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub periodic: Option<PeriodicError>,
}

/// White noise of the position sensor, added to the angle before the encoder quantises it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SensorNoise {
    /// Root mean square of the noise, rad, 0 or more. Default 5.2e-4.
    pub rms_rad: f64,
}

impl Default for SensorNoise {
    fn default() -> Self {
        SensorNoise { rms_rad: 5.2e-4 }
    }
}

/// Angle error of a sensor disc or magnet that is off the axis or tilted: `A sin(n x + phase) + A2 sin(2n x + phase2)`. `x` is the
/// angle of the device, `n` the periods per turn, `A` and `A2` are amplitudes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PeriodicError {
    /// Amplitude `A`, rad, 0 or more. Default 8.7e-3.
    pub amplitude_rad: f64,
    /// Periods per turn `n`, 1 to 100,000. Default 1.
    pub periods_per_rev: u32,
    /// Phase of the error's first component where the device is at angle 0, rad. Default 0.
    pub phase_rad: f64,
    /// Amplitude `A2` of the second component, which has twice as many periods per turn, rad, 0 or more. Default 0.
    pub second_amplitude_rad: f64,
    /// Phase of the error's second component where the device is at angle 0, rad. Default 0.
    pub second_phase_rad: f64,
}

impl Default for PeriodicError {
    fn default() -> Self {
        PeriodicError {
            amplitude_rad: 8.7e-3,
            periods_per_rev: 1,
            phase_rad: 0.0,
            second_amplitude_rad: 0.0,
            second_phase_rad: 0.0,
        }
    }
}

/// Cogging torque of the motor's magnets, `-A sin(n x + phase)`. `x` is the device's angle, `A` the amplitude, `n` the periods per
/// turn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Cogging {
    /// Amplitude of the cogging torque, N·m, 0 or more. Default 1e-3.
    pub torque_n_m: f64,
    /// Periods of the cogging torque per turn, 1 to 100,000. Default 84.
    pub periods_per_rev: u32,
    /// Phase of the cogging torque where the device is at angle 0, rad. Default 0.
    pub phase_rad: f64,
}

impl Default for Cogging {
    fn default() -> Self {
        Cogging {
            torque_n_m: 1e-3,
            // The least common multiple of 12 slots and 14 poles, a common motor.
            periods_per_rev: 84,
            phase_rad: 0.0,
        }
    }
}

/// Torque of gravity on a knob with an eccentric weight, `-A sin(x + phase)`. `x` is the device's angle, `A` the amplitude.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Imbalance {
    /// Amplitude of the torque, N·m, 0 or more: weight times its distance from the axis. Default 1e-3.
    pub torque_n_m: f64,
    /// Angle of the eccentric weight from its lowest point, while the device is at angle 0, rad. Default 0.
    pub phase_rad: f64,
}

impl Default for Imbalance {
    fn default() -> Self {
        Imbalance {
            torque_n_m: 1e-3,
            phase_rad: 0.0,
        }
    }
}

/// Errors of the motor's current sensor, which the current controller turns into torque errors. All values are given as torque:
/// current times torque constant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CurrentSensor {
    /// Root mean square of the sensor's noise, as torque, N·m, 0 or more. Default 8.7e-4.
    pub noise_rms_n_m: f64,
    /// Resolution of the sensor's analogue-to-digital converter, as torque, N·m, 0 or more. Default 8.7e-4.
    pub step_n_m: f64,
}

impl Default for CurrentSensor {
    fn default() -> Self {
        CurrentSensor {
            noise_rms_n_m: 8.7e-4,
            step_n_m: 8.7e-4,
        }
    }
}

/// First-order lag of the motor's torque behind its command, caused by a current controller or by windings that a voltage drives.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CurrentLoop {
    /// Bandwidth of the lag, Hz, above 0. Default 600. For windings driven by a voltage it is `R/(2π L)`, with winding resistance
    /// `R` and inductance `L`.
    pub bandwidth_hz: f64,
    /// Damping by the motor's back-EMF, N·m·s/rad, 0 or more. Default 0, which suits a current controller.
    ///
    /// Windings driven by a voltage have `k_t²/R`, with torque constant `k_t` and winding resistance `R`. Three phases have
    /// `k_t²/(3/2 R)`, with `k_t` as torque per ampere of the phase currents' amplitude.
    pub back_emf_n_m_s_per_rad: f64,
}

impl Default for CurrentLoop {
    fn default() -> Self {
        CurrentLoop {
            // The default of the firmware.
            bandwidth_hz: 600.0,
            back_emf_n_m_s_per_rad: 0.0,
        }
    }
}

/// A flexible transmission between the motor with the encoder on one side and the knob on the other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Transmission {
    /// Stiffness of the transmission, N·m/rad, above 0. Default 20.
    pub spring_n_m_per_rad: f64,
    /// Damping of the transmission, N·m·s/rad, 0 or more. Default 1e-3.
    pub damper_n_m_s_per_rad: f64,
    /// Inertia of the knob as a fraction of the whole device's inertia, 0.001 to 0.999. Default 0.3.
    pub knob_share: f64,
    /// Total play (backlash) of the transmission, rad, 0 or more. Default 0.
    pub play_rad: f64,
}

impl Default for Transmission {
    fn default() -> Self {
        Transmission {
            spring_n_m_per_rad: 20.0,
            damper_n_m_s_per_rad: 1e-3,
            knob_share: 0.3,
            play_rad: 0.0,
        }
    }
}

/// Tremor of the hand: its rest point moves as a sine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HandTremor {
    /// Amplitude of the rest point's motion, rad, 0 or more. Default 0.02.
    pub amplitude_rad: f64,
    /// Frequency, Hz, above 0, at most 30. Default 9.
    pub frequency_hz: f64,
}

impl Default for HandTremor {
    fn default() -> Self {
        HandTremor {
            amplitude_rad: 0.02,
            frequency_hz: 9.0,
        }
    }
}

/// Stretch reflex of the hand: muscles that answer a stretch with a torque after a delay.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HandReflex {
    /// Delay from the stretch to the muscles' torque, s, 0 to 1, rounded to whole control periods. Default 0.05.
    pub delay_s: f64,
    /// Torque of the muscles per angle of stretch, N·m/rad, 0 or more. Default 0.0225.
    pub muscle_stiffness_n_m_per_rad: f64,
}

impl Default for HandReflex {
    fn default() -> Self {
        HandReflex {
            delay_s: 0.05,
            muscle_stiffness_n_m_per_rad: 0.0225,
        }
    }
}
