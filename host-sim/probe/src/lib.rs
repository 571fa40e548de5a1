//! Writes a board's flash and reads its log through a debug probe, with the crate probe-rs, so that no other program is needed.
//!
//! All code here needs the feature `probe-rs`. Without it this crate is empty, so a build of the whole workspace does not build the
//! packages for probes. A `Lister` finds the probes; the tests use one with a simulated probe and chip.

#[cfg(feature = "probe-rs")]
mod board;

#[cfg(feature = "probe-rs")]
pub use board::{
    Attached, Event, Fault, Found, Image, LIBRARY, Line, Phase, Step, Words, attach, choose,
};
#[cfg(feature = "probe-rs")]
pub use probe_rs::probe::list::Lister;
