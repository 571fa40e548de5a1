//! What handlers of exceptions run, and what they have cost.

use super::core::Cost;
use super::nvic::FIRST;

/// The current loop, once a PWM period.
pub const CURRENT_LOOP: usize = FIRST + 18;
/// The control tick.
pub const CONTROL_TICK: usize = FIRST + 49;

/// A running exception.
#[derive(Debug, Clone, Copy)]
pub struct Running {
    /// Its number.
    pub exception: usize,
    /// When it was entered.
    pub entered: u64,
    /// The counters of its level at its entry.
    pub begin: Cost,
}

/// What the handlers of an exception have cost, without those that interrupted them.
#[derive(Debug, Clone, Copy, Default)]
pub struct Handler {
    /// How often it ran.
    pub runs: u64,
    /// Most of one run, entry and return not counted.
    pub worst: Cost,
    /// When the worst run was entered.
    pub worst_at: u64,
    /// Longest time from entry to return, with what interrupted it, cycles.
    pub longest: u64,
}
