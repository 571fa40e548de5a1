//! The emulated processor. The library Unicorn executes the instructions; this module adds the parts of a Cortex-M that Unicorn
//! lacks.
//!
//! Unicorn 2.1.5 has no interrupt controller (NVIC). It does not recognise `bx lr` as an exception return when the host has changed
//! IPSR. Unicorn therefore always stays in thread mode. The module `exception` carries out exception entry and return on Unicorn's
//! registers and memory. A jump to EXC_RETURN appears as a fetch from an address without memory. The run loop (`run`) delivers
//! interrupts only between two slices of instructions, and a slice never ends inside an IT block.

mod exception;
mod run;
mod state;
mod tamper;

pub use state::{Halt, Machine};
