//! Runs the unmodified firmware on an emulated chip with a simulated motor and hand.

pub mod bench;
pub mod board;
#[allow(dead_code, reason = "each of its readers needs some")]
#[path = "../../firmware/budgets.rs"]
mod budgets;
pub mod chip;
pub mod count;
pub mod cpu;
pub mod fil;
pub mod link;
pub mod machine;
pub mod peripheral;
pub mod played;
pub mod serve;
pub mod traces;
pub mod world;
