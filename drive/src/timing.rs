//! Cycles and lateness of a control tick.

/// Timing of a control tick, as the firmware measured it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TickTiming {
    /// Cycles from the moment that the tick was due to its first instruction.
    pub lateness: u32,
    /// Cycles of the tick before, from its first instruction to its last; 0 in the first.
    pub duration: u32,
}
