//! Devices and the communication with them.
//!
//! A board runs its control law itself. The computer sends it requests over a link:
//!
//! ```text
//! address -> transport (serial port or TCP) -> frames (protocol) -> client: requests and answers, telemetry
//! ```
//!
//! A haptic device without a control law of its own is driven from this crate, one control interval (tick) after the other:
//!
//! ```text
//! HapticDevice (simulated, omega.3, Inverse3; faults around any) <-> servo: pace, limits, release <-> ForceLaw (wall, guard)
//! ```

mod address;
mod client;
mod followed;
mod haply;
pub mod haptic;
mod moved_about;
mod omega3;
pub mod servo;
mod survey;
mod transport;
mod wall;

pub use address::{Address, Port, is_st_link, ports};
pub use client::{Client, MAY_BE_ON, may_be_on};
pub use followed::{Fading, FollowedWall, FollowerForces};
pub use haply::{Generation, Inverse3, SERVICE};
pub use moved_about::{AxisRecord, MovedAbout, SmallMotions};
pub use omega3::Omega3;
pub use survey::{Pose, Survey};
pub use transport::{Received, Transport, open};
pub use wall::{DeviceWall, Obstacle, WallSettings, guard_settings};
