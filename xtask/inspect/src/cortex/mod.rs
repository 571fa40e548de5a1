//! A program for a Cortex-M, read from its ELF file: its functions, what each reaches, how deep its stack gets.

mod instruction;
mod names;
mod program;
mod reach;
mod stack;

pub use names::{is_panic, is_soft_float};
pub use program::{ProgramCode, word};
pub use stack::Depths;
