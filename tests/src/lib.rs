//! What the tests across the crates share: motions, a flash memory, random numbers, every variant of every law.

pub mod adversary;
pub mod flash;
pub mod grain;
pub mod knob;
pub mod motion;
pub mod port;
pub mod random;
pub mod search;
pub mod si;
pub mod space;
pub mod space_port;
pub mod variants;
