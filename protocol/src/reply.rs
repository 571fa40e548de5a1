//! Messages from the device: replies to requests, and telemetry, which it sends without a request.

use crate::Board;
pub use crate::reset::ResetReason;
use crate::settings::{DeviceSettings, Invalid, KeyError, VALUE_MAX};
use crate::telemetry::{Fault, Phase, RingChunk, Telemetry};
use heapless::{String, Vec};
use serde::{Deserialize, Serialize};

/// A message from the device to the desktop, one per frame.
// A large variant is acceptable, because only one message exists at a time.
#[allow(clippy::large_enum_variant)]
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum FromDevice {
    /// The answer to a request.
    Answer {
        /// Number of the request that is answered.
        id: u8,
        /// The reply, or the reason for refusing the request.
        answer: Result<Reply, Refusal>,
    },
    /// The telemetry of one control tick.
    Telemetry(Telemetry),
}

/// The reply to a request.
#[allow(clippy::large_enum_variant)]
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Reply {
    /// Reply to `Hello`. This variant must stay the first one, with the protocol version as its first field: see
    /// [`version_of_hello`].
    Identity(Identity),
    /// Answer to `Status`: the device's state.
    Status(Status),
    /// Answer to `Get`: the setting's value, encoded by the serialiser postcard.
    Value(Vec<u8, VALUE_MAX>),
    /// Answer to `GetAll`: all settings of the device.
    Settings(DeviceSettings),
    /// The device carried out the request; there are no data to return.
    Done,
    /// Answer to `Fault`: the stored fault, if there is one.
    Fault(Option<Fault>),
    /// Answer to `Ring`: records of the ring buffer of the last second.
    Ring(RingChunk),
    /// Answer to `Counters`: the counters since the reset.
    Counters(Counters),
    /// Answer to `Environment`: the walls, end stops, detents and torque profile that the knob renders.
    #[cfg(feature = "large")]
    Environment(crate::settings::environment::Surround),
    /// Answer to `SetEnvironment`: the environment (walls, end stops, detents) was accepted and applies from this time.
    #[cfg(feature = "large")]
    Taken(crate::settings::environment::CountsFrom),
    /// Answer to `Start`: the data stored for the next start, and how the automatic start went.
    #[cfg(feature = "large")]
    Start(crate::settings::kept::StartReport),
    /// Answer to `Cogging`: the stored map of the motor's cogging torque.
    #[cfg(feature = "large")]
    Cogging(crate::settings::cogging::CoggingReport),
}

/// Reasons for refusing a request.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Refusal {
    /// The request is not allowed in this state of the device.
    NotNow(Phase),
    /// The path names no setting, or the value is not valid for the setting.
    Key(KeyError),
    /// The settings with the new value would not be valid; holds the refused setting.
    Invalid(Invalid),
    /// The flash could not be written.
    Flash,
    /// The ring buffer is still recording. It stops at a fault and can then be read.
    RingRuns,
    /// The frame's CRC was right, but the device's firmware has no such request.
    NotUnderstood,
    /// The encoder's alignment or the cogging map cannot be stored, the cogging cannot be measured, or no usable alignment is
    /// stored for an automatic start. Holds the reason.
    #[cfg(feature = "large")]
    Unkept(crate::settings::kept::Unkept),
}

/// The identity of the device: versions, board, unique number.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Version of the device's protocol: its [`crate::PROTOCOL_VERSION`].
    pub protocol_version: u16,
    /// Version of the layout of the device's settings in flash: its [`crate::stored::LAYOUT_VERSION`].
    pub settings_version: u16,
    /// Version of the firmware, e.g. `0.1.0`.
    pub firmware_version: String<16>,
    /// The board for which the firmware was built.
    pub board: Board,
    /// Unique number of the microcontroller.
    pub unique_id: [u8; 12],
    /// Reason of the last reset.
    pub reset_reason: ResetReason,
    /// Hash of the source code from which the firmware was built; 0 if unknown.
    pub build_hash: u64,
}

/// The device's state with its stored fault and the number of the tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Status {
    /// State of the state machine.
    pub phase: Phase,
    /// The stored fault, if there is one.
    pub fault: Option<Fault>,
    /// Number of control ticks since the reset, modulo 2^32.
    pub tick: u32,
    /// Whether the settings in use differ from those in flash.
    pub unsaved: bool,
}

/// Counters since the reset. Each one saturates at its largest value.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Number of received frames that could not be decoded.
    pub decode_errors: u32,
    /// Number of telemetry records dropped because the serial port was too slow.
    pub telemetry_dropped: u32,
    /// Number of control ticks.
    pub ticks: u32,
    /// Longest duration of a control tick, in processor cycles.
    pub tick_cycles_max: u32,
    /// Largest lateness of a control tick, in processor cycles from when it was due to when it began.
    pub lateness_cycles_max: u32,
    /// Longest duration of a tick of the current loop, in processor cycles.
    pub current_loop_cycles_max: u32,
}

/// Reads the protocol version from the payload of a reply to `Hello`, even if a device with another version of the protocol sent
/// it. The bytes up to the version are the same in every version of the protocol; the bytes after it may differ. `None` for every
/// other payload.
#[must_use]
pub fn version_of_hello(payload: &[u8]) -> Option<u16> {
    /// The first fields of a reply to `Hello`: variant of the frame, request number, `Ok`, variant of the reply, protocol version.
    type Start = (u8, u8, u8, u8, u16);
    match postcard::take_from_bytes::<Start>(payload) {
        Ok(((0, _, 0, 0, version), _)) => Some(version),
        _ => None,
    }
}
