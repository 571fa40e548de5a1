//! The processor at work: Unicorn executes instructions; what it does not have of a Cortex-M is here.
//!
//! Unicorn 2.1.5 has no NVIC, and does not see `bx lr` as an exception's return when the host has changed IPSR. So it never
//! leaves thread mode: entry and return are done here, on its registers and memory (`exception`), and a jump to
//! EXC_RETURN is met as a fetch from an address where nothing can be. Interrupts are delivered between two
//! slices only (`run`), and a slice never ends inside of an IT block.

mod exception;
mod run;
mod state;
mod tamper;

pub use state::{Halt, Machine};
