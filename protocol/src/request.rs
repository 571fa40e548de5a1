//! What the desktop asks of the device.

use crate::settings::DeviceSettings;
use serde::{Deserialize, Serialize};

/// Version of everything that goes over the wire: raised with each change that an older desktop or device would misread.
pub const PROTOCOL_VERSION: u16 = 7;

/// A request, and the number by which its answer is known.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ToDevice<'a> {
    /// Chosen by the desktop; the answer has the same.
    pub id: u8,
    /// What is asked.
    #[serde(borrow)]
    pub request: Request<'a>,
}

/// What is asked.
// One request is held at a time: the whole of the settings needs no place of its own.
#[allow(clippy::large_enum_variant)]
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Request<'a> {
    /// Who are you? Stays the first of all, in every version.
    Hello,
    /// Where do you stand?
    Status,
    /// The value of one setting.
    Get {
        /// Its path.
        path: &'a str,
    },
    /// Changes one setting; the whole is validated with it.
    Set {
        /// Its path.
        path: &'a str,
        /// Its value, as postcard has it.
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
    /// Telemetry from now on, one record every so many control ticks; 0 sends none. Not a setting: forgotten at a reset.
    Telemetry {
        /// Control ticks between two records.
        decimation: u16,
    },
    /// What was counted since the reset.
    Counters,
    /// What there is to touch.
    #[cfg(feature = "large")]
    Environment,
    /// Other things to touch, also while the device is armed; the largest change of force in a tick is in it.
    #[cfg(feature = "large")]
    SetEnvironment(crate::settings::environment::Surround),
    /// What is kept for the next start, and what became of this one.
    #[cfg(feature = "large")]
    Start,
    /// Keeps the alignment of the calibration that has just ended. In `Ready` only; `Save` writes it.
    #[cfg(feature = "large")]
    KeepAlignment,
    /// Keeps none any more: nothing starts by itself then, though it is asked for. `Save` writes it.
    #[cfg(feature = "large")]
    ForgetAlignment,
    /// Whether the board checks the kept alignment and arms by itself when power comes on. `Save` writes it.
    #[cfg(feature = "large")]
    Autostart(bool),
    /// The map of the cogging that is kept.
    #[cfg(feature = "large")]
    Cogging,
    /// Keeps this map, measured with what the settings say, and plays it. In `Ready` only; `Save` writes it.
    #[cfg(feature = "large")]
    KeepCogging(crate::settings::cogging::CoggingMap),
    /// Keeps none any more. Not while anything is driven; `Save` writes it.
    #[cfg(feature = "large")]
    ForgetCogging,
    /// What the next calibration goes on with; that one alone.
    #[cfg(feature = "large")]
    Sweep(crate::settings::cogging::Sweep),
}

/// What a person tells the device to do.
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
    /// This position is zero from now on. Not while armed.
    Zero,
    /// Outputs off, then a reset.
    Reboot,
}
