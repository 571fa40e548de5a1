//! The processor, except for the meaning of its instructions: counters and costs, interrupts, the program.

pub mod core;
pub mod decode;
pub mod elf;
pub mod handler;
pub mod nvic;

/// First address of the RAM.
pub const RAM: u32 = 0x2000_0000;
/// First address of the core-coupled memory (CCM), from which code runs without wait states (RM0440, 2.2: from memory, unread).
pub const CCM: u32 = 0x1000_0000;
