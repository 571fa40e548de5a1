//! Runs a scene: the plan, the loop, what it records and how it is judged.

pub mod record;
