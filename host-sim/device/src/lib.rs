//! The link to a device: how it is reached, and how it is spoken to.
//!
//! ```text
//! address -> transport (serial port or TCP) -> frames (protocol) -> client: requests and answers, telemetry
//! ```

mod address;
mod client;
mod transport;

pub use address::{Address, Port, is_st_link, ports};
pub use client::Client;
pub use transport::{Received, Transport, open};
