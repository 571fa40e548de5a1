//! Exception handlers that run, and their costs.

use super::core::Cost;
use super::nvic::FIRST;

/// The current loop, once a PWM period.
pub const CURRENT_LOOP: usize = FIRST + 18;
/// The control tick.
pub const CONTROL_TICK: usize = FIRST + 49;

/// A running exception.
#[derive(Debug, Clone, Copy)]
pub struct Running {
    /// Number of the exception.
    pub exception: usize,
    /// Time at which it was entered.
    pub entered: u64,
    /// The counters of its level at its entry.
    pub begin: Cost,
}

/// Costs of an exception's handlers, without those of handlers that interrupted them.
#[derive(Debug, Clone, Copy, Default)]
pub struct Handler {
    /// How often it ran.
    pub runs: u64,
    /// Most of one run, entry and return not counted.
    pub worst: Cost,
    /// Time at which the longest run was entered.
    pub worst_at: u64,
    /// Longest time from entry to return, with what interrupted it, cycles.
    pub longest: u64,
}
