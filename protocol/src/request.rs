//! Requests of the desktop to the device.

use crate::settings::DeviceSettings;
use serde::{Deserialize, Serialize};

/// Version of everything that goes over the wire: raised with each change that an older desktop or device would misread.
pub const PROTOCOL_VERSION: u16 = 8;

/// A request, and the number by which its answer is known.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ToDevice<'a> {
    /// Chosen by the desktop; the answer has the same.
    pub id: u8,
    /// The request.
    #[serde(borrow)]
    pub request: Request<'a>,
}

/// The requests of the desktop.
// One request is held at a time: the whole of the settings needs no place of its own.
#[allow(clippy::large_enum_variant)]
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Request<'a> {
    /// Asks for the device's identity. Stays the first request in every version.
    Hello,
    /// Asks for the state of the device.
    Status,
    /// The value of one setting.
    Get {
        /// The setting's path.
        path: &'a str,
    },
    /// Changes one setting; all settings are then validated together.
    Set {
        /// The setting's path.
        path: &'a str,
        /// The new value, encoded by postcard.
        value: &'a [u8],
    },
    /// All settings.
    GetAll,
    /// Changes all settings at once; validated as a whole, taken or refused as a whole.
    SetAll(DeviceSettings),
    /// Back to the defaults, not saved.
    Defaults,
    /// Writes the settings into flash.
    Save,
    /// A command.
    Command(DeviceCommand),
    /// The latched fault.
    Fault,
    /// Part of the ring of the last second.
    Ring {
        /// Index of the first record that is wanted; 0 is the oldest.
        first: u16,
    },
    /// Starts telemetry, one record every given number of control ticks; 0 stops it. Not a setting: forgotten at a
    /// reset.
    Telemetry {
        /// Control ticks between two records.
        decimation: u16,
    },
    /// The counters since the reset.
    Counters,
    /// What there is to touch.
    #[cfg(feature = "large")]
    Environment,
    /// Replaces the environment, also while the device is armed; it includes the largest change of force in a tick.
    #[cfg(feature = "large")]
    SetEnvironment(crate::settings::environment::Surround),
    /// Asks for the data kept for the next start and for the outcome of this start.
    #[cfg(feature = "large")]
    Start,
    /// Keeps the alignment of the calibration that has just ended. In `Ready` only; `Save` writes it.
    #[cfg(feature = "large")]
    KeepAlignment,
    /// Forgets the kept alignment: the board then cannot start unattended, even if autostart is on. `Save` writes it.
    #[cfg(feature = "large")]
    ForgetAlignment,
    /// Whether the board checks the kept alignment and arms unattended when power comes on. `Save` writes it.
    #[cfg(feature = "large")]
    Autostart(bool),
    /// The map of the cogging that is kept.
    #[cfg(feature = "large")]
    Cogging,
    /// Keeps this cogging map, which was measured with the present settings, and plays it. In `Ready` only; `Save`
    /// writes it.
    #[cfg(feature = "large")]
    KeepCogging(crate::settings::cogging::CoggingMap),
    /// Keeps none any more. Not while anything is driven; `Save` writes it.
    #[cfg(feature = "large")]
    ForgetCogging,
    /// A measurement that the next calibration goes on with, and only that one.
    #[cfg(feature = "large")]
    Sweep(crate::settings::cogging::Sweep),
}

/// Commands of a person to the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum DeviceCommand {
    /// Find direction, pole pairs and electrical offset: the shaft moves.
    Calibrate,
    /// Switch the outputs on.
    Arm,
    /// Switch the outputs off, keep the calibration.
    Disarm,
    /// Switch off and forget the calibration; clears a fault.
    Stop,
    /// Makes this position zero. Not while armed.
    Zero,
    /// Outputs off, then a reset.
    Reboot,
}
