//! All decisions of the firmware, from raw readings to compare values, with plain structs as inputs and outputs.
//!
//! ```text
//! encoder register -> decode (encoder) -> unwrap (protocol) -> supervisor -> fault machine (protocol)
//!   -> penetration, law (control, unchanged) -> torque -> current (command) -> mailbox -> current loop (current) -> compare values
//! ```
//!
//! The firmware's interrupts mainly make two calls: [`CurrentLoop::tick`] once per PWM period and [`Device::tick`] once per
//! control period. No call waits, allocates, panics, reads a clock or a register, or calculates with floats. So all functions
//! give the same results on any machine.
//!
//! Read the modules in this order: [`device`] for one control period, [`command`] for how its torque becomes a command,
//! [`current`] for one PWM period, [`supervisor`] for the faults, and [`calibration`] for the values that must be known before
//! the first torque.
//!
//! | word | meaning | type |
//! |---|---|---|
//! | current | A, positive into the motor | [`Amps`] |
//! | voltage | V | [`Volts`] |
//! | electrical angle | fraction of a turn of the rotor's field, wraps after a whole turn | [`Angle`] |
//! | d, q | along the rotor's field, and a quarter turn ahead of it: the torque is `k_t i_q` | |
//! | duty | compare value, 0 to the timer's top; the phase's voltage rises with it | `u16` |
//! | tick | one control period | |
//! | period | one PWM period, in which the current loop runs once | |
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

pub mod angle;
#[cfg(feature = "large")]
pub mod around;
#[cfg(feature = "large")]
pub mod autostart;
pub mod calibration;
pub mod change;
#[cfg(feature = "large")]
pub mod cogging;
pub mod command;
pub mod config;
pub mod current;
pub mod device;
pub mod encoder;
pub mod exchange;
pub mod hardware;
pub mod input;
pub mod mailbox;
pub mod measurement;
pub mod modulation;
pub mod output;
pub mod pi;
pub mod record;
pub mod ring;
mod scenery;
pub mod settings;
pub mod supervisor;
#[cfg(feature = "large")]
pub mod sweep;
pub mod thermistor;
pub mod timing;
pub mod transform;
#[cfg(feature = "wire")]
pub mod twin;
pub mod units;
#[cfg(feature = "wire")]
pub mod wire;

pub use angle::Angle;
pub use calibration::{Calibration, Reason};
pub use command::{DacCode, DriveCommand};
pub use config::Config;
pub use current::{
    BridgeCommand, CurrentCommand, CurrentConfig, CurrentLoop, CurrentMode, CurrentOutput,
    CurrentReport, CurrentSample, Trip,
};
pub use device::Device;
pub use encoder::{EncoderError, EncoderKind, EncoderReading};
pub use hardware::Hardware;
pub use input::ControlInput;
pub use output::ControlOutput;
pub use record::Record;
pub use ring::{CompactRecord, Ring};
pub use timing::TickTiming;

pub use touchstone_control::Si;
pub use touchstone_protocol::DeviceSettings;
pub use touchstone_protocol::reset::{self, ResetFlags, ResetReason};
pub use touchstone_protocol::settings::SettingsError;

/// A current, A: ±32,768 in steps of 15 µA.
pub type Amps = fixed::types::I16F16;
/// A voltage, V: ±32,768 in steps of 15 µV.
pub type Volts = fixed::types::I16F16;
/// A temperature in degrees Celsius, ±32,768 in steps of 1.5e-5.
pub type Celsius = fixed::types::I16F16;
