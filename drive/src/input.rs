//! Inputs of a control tick.

use crate::current::CurrentReport;
use crate::encoder::EncoderReading;
use crate::timing::TickTiming;
use touchstone_protocol::Command;

/// The values that the firmware read for a control tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ControlInput {
    /// The encoder.
    pub encoder: EncoderReading,
    /// The current loop's mailbox; the default for a board without one.
    pub current: CurrentReport,
    /// The command of a person or the desktop, if there is one.
    pub command: Option<Command>,
    /// The hardware break has pulled since [`ControlOutput::clear_latches`](crate::ControlOutput::clear_latches) was last given.
    pub hardware_break: bool,
    /// The gate driver reports an error.
    pub gate_driver_error: bool,
    /// The board's stop button is pressed.
    pub stop_button: bool,
    /// The desktop was heard since the last tick: a whole frame came.
    pub host_heard: bool,
    /// Processor cycles of the tick.
    pub timing: TickTiming,
}
