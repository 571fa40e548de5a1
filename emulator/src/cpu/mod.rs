//! The processor apart from its instructions' meaning: counters and costs, interrupts, the program.

pub mod core;
pub mod decode;
pub mod elf;
pub mod handler;
pub mod nvic;

/// Where RAM begins.
pub const RAM: u32 = 0x2000_0000;
/// Where the CCM is fetched from without wait states (RM0440, 2.2: from memory, unread).
pub const CCM: u32 = 0x1000_0000;
