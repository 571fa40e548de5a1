//! Duration and lateness of a control interrupt, in processor cycles.

/// Timing of a control interrupt, as the firmware measured it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TickTiming {
    /// Processor cycles from the time at which the control interrupt was due to its first instruction.
    pub lateness: u32,
    /// Processor cycles of the previous control interrupt, from its first instruction to its last; 0 for the first one.
    pub duration: u32,
}
