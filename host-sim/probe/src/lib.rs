//! Boards behind a probe: their flash is written and their log is read by the crate probe-rs, so that no other program has to be
//! installed.
//!
//! Everything here needs the feature `probe-rs`. Without it this crate is empty, and what builds the whole workspace builds none of
//! the packages that a probe needs. Probes come from a `Lister`, so that the tests bring one of their own, with a chip in software
//! behind it.

#[cfg(feature = "probe-rs")]
mod board;

#[cfg(feature = "probe-rs")]
pub use board::{
    Attached, Event, Fault, Found, Image, LIBRARY, Line, Phase, Step, Words, attach, choose,
};
#[cfg(feature = "probe-rs")]
pub use probe_rs::probe::list::Lister;
