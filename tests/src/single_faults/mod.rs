//! A table of single faults: one part of a running knob breaks. The table shows the energy that the hand then gets until the device
//! is off.
//!
//! ```text
//! FAULTS (list.rs) x boards, moments, grips (bench.rs) -> Cell (cell.rs) -> table for the documentation (table.rs)
//! known.rs: known gaps breaks by: readings and bridge (tamper.rs), encoder (encoder.rs), motor, host, memory (act.rs)
//! ```
//!
//! The model is the firmware's whole drive on the desktop, without pins. Faults of the hardware break, of the watchdogs and of
//! their wiring are injected in the emulator instead (`cargo xtask fil`).

mod act;
mod bench;
mod broken;
mod cell;
mod encoder;
mod known;
mod list;
mod table;
mod tamper;

pub use bench::{Bench, Grip, Moment, Played, good, ready};
pub use cell::{Cell, Row, run};
pub use encoder::Encoder;
pub use known::UNFOUND;
pub use list::{FAULTS, Fault, Group, Same};
pub use table::Table;
pub use tamper::{Breaks, Broken};

/// Most energy that a single fault may give a hand on any board, J.
pub const MOST_J: f64 = 0.25;
