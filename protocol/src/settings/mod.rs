//! Everything that a device can be told, as one tree: each leaf has a path with its unit in its name, and its bounds.
//!
//! ```text
//! person's text <-> leaf (path, value) <-> DeviceSettings --validate--> control::Settings, drive
//! ```
//!
//! The same code validates on both sides: what the desktop accepts, the device does.

mod access;
mod choice;
mod convert;
pub(crate) mod decimal;
mod defaults;
pub mod fields;
mod validate;

use miniconf::Tree;
use serde::{Deserialize, Serialize};

pub use access::{KeyError, VALUE_MAX};
pub use choice::{
    DriveKind, EncoderKind, FirstContact, IdealStep, Law, Observer, OffsetUpdate, Regulate,
};
pub use decimal::Decimal;
pub use validate::{Invalid, PATH_MAX, PathText, Reason, refused};

/// Everything that a device can be told.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, Tree)]
#[serde(deny_unknown_fields)]
pub struct DeviceSettings {
    /// When the control interrupt runs.
    pub control: ControlSettings,
    /// The wall and its law.
    pub wall: WallSettings,
    /// The encoder.
    pub encoder: EncoderSettings,
    /// What moves the shaft.
    pub drive: DriveSettings,
    /// The motor.
    pub motor: MotorSettings,
    /// Beyond these the outputs are switched off.
    pub limits: LimitSettings,
    /// How the encoder is aligned with the motor.
    pub calibration: CalibrationSettings,
    /// What is sent by itself.
    pub telemetry: TelemetrySettings,
}

/// When the control interrupt runs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, Tree)]
#[serde(deny_unknown_fields)]
pub struct ControlSettings {
    /// Control rate `1/T`, Hz; a whole fraction of the PWM rate.
    pub rate_hz: u32,
}

/// The wall and its law: [`touchstone_control::Settings`] and the place of the surface. Their control rate is
/// [`ControlSettings::rate_hz`].
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, Tree)]
#[serde(deny_unknown_fields)]
pub struct WallSettings {
    /// Where the surface is, rad from the calibrated zero; inside is beyond it.
    #[tree(with = miniconf::leaf)]
    pub surface_rad: Decimal,
    /// Which law.
    #[tree(with = miniconf::leaf)]
    pub law: Law,
    /// Desired stiffness `k_de`, N·m/rad.
    #[tree(with = miniconf::leaf)]
    pub k_desired_n_m_per_rad: Decimal,
    /// Soft, inherently stable stiffness `k_v`, N·m/rad.
    #[tree(with = miniconf::leaf)]
    pub k_soft_n_m_per_rad: Decimal,
    /// Damping `c_i` that device and fingertip are trusted to have, N·m·s/rad.
    #[tree(with = miniconf::leaf)]
    pub device_damping_n_m_s_per_rad: Decimal,
    /// Virtual damping of the spring-damper law, N·m·s/rad.
    #[tree(with = miniconf::leaf)]
    pub virtual_damping_n_m_s_per_rad: Decimal,
    /// Observer form of TDPA, alone or inside the enhanced law.
    #[tree(with = miniconf::leaf)]
    pub observer: Observer,
    /// TDPA: count `c_i` as dissipation.
    pub count_device_damping: bool,
    /// What happens when the first contact ends.
    #[tree(with = miniconf::leaf)]
    pub first_contact: FirstContact,
    /// Which stiffness the offset regulates.
    #[tree(with = miniconf::leaf)]
    pub regulate: Regulate,
    /// When the offset is changed.
    #[tree(with = miniconf::leaf)]
    pub offset_update: OffsetUpdate,
    /// What the ideal step supposes of the hand.
    #[tree(with = miniconf::leaf)]
    pub ideal_step: IdealStep,
    /// `c`, the part of the ideal step that is taken, 0 to 1.
    #[tree(with = miniconf::leaf)]
    pub step_of_ideal: Decimal,
    /// `b`, the largest step of the force as a part of it, 0 to 1.
    #[tree(with = miniconf::leaf)]
    pub limit_of_force: Decimal,
    /// `a`, the largest step of the offset as a part of the penetration, 0 to 1.
    #[tree(with = miniconf::leaf)]
    pub limit_of_penetration: Decimal,
    /// The virtual mass of the enhanced law.
    pub filter: FilterSettings,
    /// Energy that one contact of the enhanced law may give beyond what it took, J; 0 is strictly passive.
    #[tree(with = miniconf::leaf)]
    pub energy_credit_j: Decimal,
    /// Largest torque ever commanded, N·m.
    #[tree(with = miniconf::leaf)]
    pub force_limit_n_m: Decimal,
}

/// The virtual mass of the enhanced law.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, Tree)]
#[serde(deny_unknown_fields)]
pub struct FilterSettings {
    /// Virtual inertia, kg·m².
    #[tree(with = miniconf::leaf)]
    pub mass_kg_m2: Decimal,
    /// Coupling stiffness `k_f`, N·m/rad.
    #[tree(with = miniconf::leaf)]
    pub stiffness_n_m_per_rad: Decimal,
    /// Coupling damping `c_f`, N·m·s/rad.
    #[tree(with = miniconf::leaf)]
    pub damping_n_m_s_per_rad: Decimal,
    /// Damping to ground `c_env`, N·m·s/rad.
    #[tree(with = miniconf::leaf)]
    pub ground_damping_n_m_s_per_rad: Decimal,
}

/// The encoder.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, Tree)]
#[serde(deny_unknown_fields)]
pub struct EncoderSettings {
    /// Which one.
    #[tree(with = miniconf::leaf)]
    pub kind: EncoderKind,
    /// Counts a revolution, all edges counted (four times the lines); 16,384 for the magnetic ones.
    pub counts_per_rev: u32,
    /// Turning the other way is positive.
    pub reversed: bool,
    /// Bad readings in a row that make a fault.
    pub bad_readings: u8,
}

/// What moves the shaft.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, Tree)]
#[serde(deny_unknown_fields)]
pub struct DriveSettings {
    /// Which.
    #[tree(with = miniconf::leaf)]
    pub kind: DriveKind,
    /// Analogue: torque at the upper end of the output, N·m; its negative at the lower, none in the middle.
    #[tree(with = miniconf::leaf)]
    pub analogue_full_scale_n_m: Decimal,
}

/// The motor. Resistance and inductance are those of one phase to the star point: half of what is measured between two wires.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, Tree)]
#[serde(deny_unknown_fields)]
pub struct MotorSettings {
    /// Pole pairs; the calibration compares them with what it finds.
    pub pole_pairs: u8,
    /// Resistance of one phase, Ω.
    #[tree(with = miniconf::leaf)]
    pub resistance_ohm: Decimal,
    /// Inductance of one phase, H.
    #[tree(with = miniconf::leaf)]
    pub inductance_h: Decimal,
    /// Torque for a q-axis current of 1 A, N·m/A.
    #[tree(with = miniconf::leaf)]
    pub torque_constant_n_m_per_a: Decimal,
    /// Largest current, A.
    #[tree(with = miniconf::leaf)]
    pub current_limit_a: Decimal,
    /// Bandwidth of the current loop, Hz.
    #[tree(with = miniconf::leaf)]
    pub current_bandwidth_hz: Decimal,
}

/// Beyond these the outputs are switched off.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, Tree)]
#[serde(deny_unknown_fields)]
pub struct LimitSettings {
    /// Phase current, A.
    #[tree(with = miniconf::leaf)]
    pub trip_current_a: Decimal,
    /// Lowest bus voltage, V.
    #[tree(with = miniconf::leaf)]
    pub bus_min_v: Decimal,
    /// Highest bus voltage, V.
    #[tree(with = miniconf::leaf)]
    pub bus_max_v: Decimal,
    /// From here the current is reduced, °C.
    #[tree(with = miniconf::leaf)]
    pub derate_from_celsius: Decimal,
    /// Here nothing is left of it, °C.
    #[tree(with = miniconf::leaf)]
    pub fault_from_celsius: Decimal,
    /// Highest speed, rad/s.
    #[tree(with = miniconf::leaf)]
    pub max_speed_rad_per_s: Decimal,
    /// Time over which the torque fades in after arming, s.
    #[tree(with = miniconf::leaf)]
    pub fade_in_s: Decimal,
}

/// How the encoder is aligned with the motor.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, Tree)]
#[serde(deny_unknown_fields)]
pub struct CalibrationSettings {
    /// Current of the field that turns the shaft, A.
    #[tree(with = miniconf::leaf)]
    pub current_a: Decimal,
    /// Speed of the field, electrical turns a second.
    #[tree(with = miniconf::leaf)]
    pub electrical_turns_per_s: Decimal,
}

/// What is sent by itself.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, Tree)]
#[serde(deny_unknown_fields)]
pub struct TelemetrySettings {
    /// One record every so many control ticks; 0 sends none.
    pub decimation: u16,
}
