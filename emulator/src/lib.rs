//! Runs the unmodified firmware on an emulated chip with a simulated motor and hand.

pub mod bench;
pub mod board;
pub mod chip;
pub mod count;
pub mod cpu;
pub mod fil;
pub mod link;
pub mod machine;
pub mod peripheral;
pub mod serve;
pub mod world;
