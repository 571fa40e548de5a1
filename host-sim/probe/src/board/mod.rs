//! Actions on a board behind a probe, in their order.

pub mod choose;
mod fault;
mod image;
mod log;
mod session;
mod words;
mod write;

pub use choose::Found;
pub use fault::Fault;
pub use image::Image;
pub use log::Event;
pub use session::{Attached, attach};
pub use words::{Line, Words};
pub use write::{Phase, Step};

/// The crate that does it, as in `Cargo.toml`.
pub const LIBRARY: &str = "probe-rs 0.32.0";
