//! Writes a program into a board's flash and reads the program's log through a debug probe. It uses the crate probe-rs, so that the
//! user needs no other program.
//!
//! All code of this crate needs the feature `probe-rs`. Without the feature this crate is empty, so that a build of the whole
//! workspace does not build probe-rs. A `Lister` of probe-rs finds the probes; the tests use one with a simulated probe and chip.

#[cfg(feature = "probe-rs")]
mod board;

#[cfg(feature = "probe-rs")]
pub use board::{
    Attached, ConnectedProbe, Event, Fault, Image, LIBRARY, Line, Phase, Step, Words, attach,
    choose,
};
#[cfg(feature = "probe-rs")]
pub use probe_rs::probe::list::Lister;
