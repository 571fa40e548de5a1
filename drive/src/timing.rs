//! Duration and lateness of a control tick, in processor cycles.

/// Timing of a control tick, as the firmware measured it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TickTiming {
    /// Processor cycles from the time at which the tick was due to its first instruction.
    pub lateness: u32,
    /// Processor cycles of the tick before, from its first instruction to its last; 0 in the first tick.
    pub duration: u32,
}
