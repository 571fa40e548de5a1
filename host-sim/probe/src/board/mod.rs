//! Actions on a board behind a debug probe: choose the probe, connect, write the program, read its log.

pub mod choose;
mod fault;
mod image;
mod log;
mod session;
mod words;
mod write;

pub use choose::ConnectedProbe;
pub use fault::Fault;
pub use image::Image;
pub use log::Event;
pub use session::{Attached, attach};
pub use words::{Line, Words};
pub use write::{Phase, Step};

/// Name and version of the crate through which this program accesses the probe, as in `Cargo.toml`.
pub const LIBRARY: &str = "probe-rs 0.32.0";
