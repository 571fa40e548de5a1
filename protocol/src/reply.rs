//! Replies of the device, and what it sends unrequested.

use crate::Board;
use crate::settings::{DeviceSettings, Invalid, KeyError, VALUE_MAX};
use crate::telemetry::{Fault, Phase, RingChunk, Telemetry};
use heapless::{String, Vec};
use serde::{Deserialize, Serialize};

/// A frame from the device.
// One frame is held at a time.
#[allow(clippy::large_enum_variant)]
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum FromDevice {
    /// The answer to a request.
    Answer {
        /// The number of the request.
        id: u8,
        /// The reply, or why the request is refused.
        answer: Result<Reply, Refusal>,
    },
    /// The telemetry of one control tick.
    Telemetry(Telemetry),
}

/// The reply to a request.
#[allow(clippy::large_enum_variant)]
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Reply {
    /// Reply to `Hello`. It stays the first variant, with the version as its first field: see [`version_of_hello`].
    Identity(Identity),
    /// Answer to `Status`.
    Status(Status),
    /// Answer to `Get`: the value in postcard's encoding.
    Value(Vec<u8, VALUE_MAX>),
    /// Answer to `GetAll`.
    Settings(DeviceSettings),
    /// The request was carried out.
    Done,
    /// Answer to `Fault`.
    Fault(Option<Fault>),
    /// Answer to `Ring`.
    Ring(RingChunk),
    /// Answer to `Counters`.
    Counters(Counters),
    /// Answer to `Environment`.
    #[cfg(feature = "large")]
    Environment(crate::settings::environment::Surround),
    /// Answer to `SetEnvironment`: the environment was accepted.
    #[cfg(feature = "large")]
    Taken(crate::settings::environment::CountsFrom),
    /// Answer to `Start`.
    #[cfg(feature = "large")]
    Start(crate::settings::kept::StartReport),
    /// Answer to `Cogging`.
    #[cfg(feature = "large")]
    Cogging(crate::settings::cogging::CoggingReport),
}

/// Reasons for refusing a request.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Refusal {
    /// The request is not allowed in this state of the device.
    NotNow(Phase),
    /// No such setting, or no such value.
    Key(KeyError),
    /// The settings would not be valid with the new value.
    Invalid(Invalid),
    /// The flash could not be written.
    Flash,
    /// The ring runs: it stops at a fault, and can be read then.
    RingRuns,
    /// The frame was whole, but the device does not know this request.
    NotUnderstood,
    /// The alignment cannot be kept, or there is none to start with.
    #[cfg(feature = "large")]
    Unkept(crate::settings::kept::Unkept),
}

/// The identity of the device.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// [`crate::PROTOCOL_VERSION`] of the device.
    pub protocol_version: u16,
    /// [`crate::stored::LAYOUT_VERSION`] of the device.
    pub settings_version: u16,
    /// Version of the firmware, e.g. `0.1.0`.
    pub firmware_version: String<16>,
    /// The board for which the firmware was built.
    pub board: Board,
    /// Unique number of the microcontroller.
    pub unique_id: [u8; 12],
    /// Reason of the last start.
    pub reset_reason: ResetReason,
    /// Hash of the source that the firmware was built from, 0 if unknown.
    pub build_hash: u64,
}

/// Why the device last started.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum ResetReason {
    /// Power came on.
    PowerOn,
    /// Power dipped, and came back before memory was lost.
    BrownOut,
    /// The reset pin: button or probe.
    Pin,
    /// The firmware (`Reboot`) or a probe reset the processor.
    Software,
    /// The independent watchdog was not fed.
    IndependentWatchdog,
    /// The window watchdog was not fed, or too early.
    WindowWatchdog,
    /// A panic; where, as its record says.
    Panic(u32),
    /// The option bytes were loaded.
    OptionBytes,
    /// A forbidden low-power mode.
    LowPower,
}

impl ResetReason {
    /// Text for people.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::PowerOn => "power on",
            Self::BrownOut => "brown-out",
            Self::Pin => "reset pin",
            Self::Software => "software",
            Self::IndependentWatchdog => "independent watchdog",
            Self::WindowWatchdog => "window watchdog",
            Self::Panic(_) => "panic",
            Self::OptionBytes => "option bytes",
            Self::LowPower => "low-power mode",
        }
    }
}

/// State of the device.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Status {
    /// State of the fault machine.
    pub phase: Phase,
    /// The latched fault.
    pub fault: Option<Fault>,
    /// Control ticks since the reset, modulo 2^32.
    pub tick: u32,
    /// Whether the settings in use differ from those in flash.
    pub unsaved: bool,
}

/// Counters since the reset; each stays at its largest value.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counters {
    /// Frames that could not be decoded.
    pub decode_errors: u32,
    /// Telemetry records that the port could not carry.
    pub telemetry_dropped: u32,
    /// Control ticks.
    pub ticks: u32,
    /// Longest control tick, processor cycles.
    pub tick_cycles_max: u32,
    /// Latest start of a control tick, processor cycles after it was due.
    pub lateness_cycles_max: u32,
    /// Longest tick of the current loop, processor cycles.
    pub current_loop_cycles_max: u32,
}

/// The protocol version in the payload of a reply to `Hello`, whatever version sent it: the bytes before it never
/// change, those after it may. `None` for every other payload.
#[must_use]
pub fn version_of_hello(payload: &[u8]) -> Option<u16> {
    /// Frame kind, id, `Ok`, kind of reply, version.
    type Start = (u8, u8, u8, u8, u16);
    match postcard::take_from_bytes::<Start>(payload) {
        Ok(((0, _, 0, 0, version), _)) => Some(version),
        _ => None,
    }
}
