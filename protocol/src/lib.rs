//! What firmware and desktop share: from the encoder's counter to an unbroken count ([`unwrap`]), and the states that decide
//! whether the outputs may be on ([`machine`]).
//!
//! Both are pure functions of a state and an input: no clock, no hardware, no allocation, no panic.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]

#[cfg(kani)]
extern crate kani;

pub mod machine;
pub mod unwrap;

pub use machine::{Command, Context, Event, FaultCode, Machine, Outputs, State};
pub use unwrap::{Unwrap16, Unwrap32};
