//! Analyses a program for a Cortex-M from its ELF file: its functions, the functions that each one calls, and the largest depth of
//! the stack.

mod instruction;
mod names;
mod program;
mod reach;
mod stack;

pub use names::{is_panic, is_soft_float};
pub use program::{ProgramCode, word};
pub use stack::Depths;
