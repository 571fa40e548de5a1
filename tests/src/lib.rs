//! What the tests across the crates share: motions, random numbers, every variant of every law.

pub mod motion;
pub mod random;
pub mod variants;
