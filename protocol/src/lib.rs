//! Code that firmware and desktop share: [`unwrap`] for an unbroken encoder count, [`machine`] for the states that decide whether
//! the outputs may be on, [`settings`] for a device's settings. The feature `wire` adds the communication: the encoding of settings
//! on the wire and in flash, requests and replies, telemetry, and the frames around them.
//!
//! All functions are pure functions of a state and an input: no clock, no hardware, no allocation, no panic.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

#[cfg(kani)]
extern crate kani;

pub mod board;
pub mod limit;
pub mod machine;
pub mod measuring;
pub mod reset;
pub mod settings;
pub mod unwrap;

#[cfg(feature = "flash")]
pub mod flash;
#[cfg(feature = "wire")]
pub mod frame;
#[cfg(feature = "wire")]
pub mod reply;
#[cfg(feature = "wire")]
pub mod request;
#[cfg(feature = "wire")]
pub mod session;
#[cfg(feature = "wire")]
pub mod stored;
#[cfg(feature = "wire")]
pub mod telemetry;

/// The crate of the control laws, re-exported so that a user need not depend on the same version of it.
pub use touchstone_control;

pub use board::Board;
pub use limit::{Limit, Limits};
pub use machine::{Command, Context, Event, FaultCode, Machine, Outputs, State};
pub use measuring::MeasuringPart;
pub use reset::{ResetFlags, ResetReason};
pub use settings::{Decimal, DeviceSettings};
pub use unwrap::{Unwrap16, Unwrap32};

#[cfg(feature = "large")]
pub use settings::cogging::{CoggingHarmonic, CoggingMap, CoggingReport, KeptCogging, Sweep};
#[cfg(feature = "large")]
pub use settings::environment::{CountsFrom, Surround};
#[cfg(feature = "large")]
pub use settings::kept::{KeptAlignment, KeptStart, SelfStart, StartReport, Unkept};

#[cfg(feature = "wire")]
pub use measuring::MeasuringTick;
#[cfg(feature = "wire")]
pub use reply::{Counters, FromDevice, Identity, Refusal, Reply, Status};
#[cfg(feature = "wire")]
pub use request::{DeviceCommand, PROTOCOL_VERSION, Request, ToDevice};
#[cfg(feature = "wire")]
pub use telemetry::{Fault, Phase, RingChunk, RingRecord, Telemetry};

/// The example code of the README, compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct Readme;
