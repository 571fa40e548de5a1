//! Requests of the desktop to the device.

use crate::settings::DeviceSettings;
use serde::{Deserialize, Serialize};

/// Version of the protocol. It rises with each change that an older desktop or device would misread.
pub const PROTOCOL_VERSION: u16 = 9;

/// A request with a number that its answer repeats.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ToDevice<'a> {
    /// Number that the desktop chooses; the answer repeats it.
    pub id: u8,
    /// The request itself.
    #[serde(borrow)]
    pub request: Request<'a>,
}

/// What the desktop can request of the device.
// A large variant is acceptable, because only one request exists at a time. So the settings need no separate memory.
#[allow(clippy::large_enum_variant)]
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Request<'a> {
    /// Requests the device's identity. It must stay the first variant in every version of the protocol.
    Hello,
    /// Requests the state of the device.
    Status,
    /// Requests the value of one setting.
    Get {
        /// The setting's path.
        path: &'a str,
    },
    /// Changes one setting. The device then validates all settings together.
    Set {
        /// The setting's path.
        path: &'a str,
        /// The new value, encoded by the serialiser postcard.
        value: &'a [u8],
    },
    /// Requests all settings.
    GetAll,
    /// Changes all settings at once. The device validates them together and accepts or refuses all.
    SetAll(DeviceSettings),
    /// Sets all settings to the board's defaults, without saving them to flash.
    Defaults,
    /// Writes the settings into flash.
    Save,
    /// Sends a command, e.g. to calibrate or arm.
    Command(DeviceCommand),
    /// Requests the stored fault.
    Fault,
    /// Requests part of the ring buffer, which holds the records of the last second.
    Ring {
        /// Index of the first requested record; 0 is the oldest.
        first: u16,
    },
    /// Sends one telemetry record every `decimation` control ticks; 0 stops telemetry. Does not change the settings: after a
    /// reset or a change of settings the setting `telemetry.decimation` applies again.
    Telemetry {
        /// Control ticks between two records.
        decimation: u16,
    },
    /// Requests the counters since the reset.
    Counters,
    /// Requests the environment: the walls, end stops and detents that the knob renders.
    #[cfg(feature = "large")]
    Environment,
    /// Replaces the environment (walls, end stops, detents), also while the device is armed. The environment includes the rate at
    /// which the force may change meanwhile.
    #[cfg(feature = "large")]
    SetEnvironment(crate::settings::environment::Surround),
    /// Requests the data stored for the next start, and how the automatic start went since power came on.
    #[cfg(feature = "large")]
    Start,
    /// Stores the encoder's alignment with the motor from the calibration that has just ended. Only in the state `Ready`; `Save`
    /// writes it to flash.
    #[cfg(feature = "large")]
    KeepAlignment,
    /// Discards the stored encoder alignment. The board then cannot start by itself at power-on, even if autostart is on. `Save`
    /// writes this to flash.
    #[cfg(feature = "large")]
    ForgetAlignment,
    /// Sets whether the board, when power comes on, checks the stored encoder alignment and switches its outputs on by itself.
    /// `Save` writes this to flash.
    #[cfg(feature = "large")]
    Autostart(bool),
    /// Requests the stored map of the motor's cogging torque.
    #[cfg(feature = "large")]
    Cogging,
    /// Stores this map of the motor's cogging torque, which was measured with the present settings, and uses it for compensation.
    /// Only in the state `Ready`; `Save` writes it to flash.
    #[cfg(feature = "large")]
    KeepCogging(crate::settings::cogging::CoggingMap),
    /// Discards the stored map of the motor's cogging torque. Not while the motor is driven (`Calibrating`, `Armed`); `Save` writes
    /// this to flash.
    #[cfg(feature = "large")]
    ForgetCogging,
    /// Adds a slow turn of the shaft both ways, which measures the cogging, to the next calibration only.
    #[cfg(feature = "large")]
    Sweep(crate::settings::cogging::Sweep),
}

/// Commands that a person gives to the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum DeviceCommand {
    /// Finds the encoder's direction and the electrical offset, and checks the pole pairs; the shaft moves.
    Calibrate,
    /// Switches the outputs on.
    Arm,
    /// Switches the outputs off and keeps the calibration.
    Disarm,
    /// Switches the outputs off and discards the calibration; clears a fault.
    Stop,
    /// Makes the present position the zero of the encoder count. Not while calibrating or armed.
    Zero,
    /// Switches the outputs off and resets the processor.
    Reboot,
}
