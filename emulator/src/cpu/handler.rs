//! Which exception handlers of the firmware run, and how many instructions and cycles they take.

use super::core::Cost;
use super::nvic::FIRST;

/// Exception number of the current loop, which runs once per PWM period.
pub const CURRENT_LOOP: usize = FIRST + 18;
/// Exception number of the control interrupt, which runs once per control period.
pub const CONTROL_TICK: usize = FIRST + 49;

/// An exception whose handler has been entered and has not returned.
#[derive(Debug, Clone, Copy)]
pub struct Running {
    /// Number of the exception, as in the register IPSR.
    pub exception: usize,
    /// Time at which the handler was entered, in processor cycles.
    pub entered: u64,
    /// Values of the cost counters of this nesting level when the handler was entered.
    pub begin: Cost,
}

/// Costs of the handlers of one exception, without the costs of handlers that interrupted them.
#[derive(Debug, Clone, Copy, Default)]
pub struct Handler {
    /// Number of times that the handler ran.
    pub runs: u64,
    /// Largest cost of a single run, without exception entry and return.
    pub worst: Cost,
    /// Time at which the costliest run was entered, in processor cycles.
    pub worst_at: u64,
    /// Longest time from entry to return in processor cycles, including handlers that interrupted the run.
    pub longest: u64,
}
