//! Inputs of a control period.

use crate::current::CurrentReport;
use crate::encoder::EncoderReading;
use crate::timing::TickTiming;
use touchstone_protocol::Command;

/// The values that the firmware read for a control period.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ControlInput {
    /// The encoder's raw reading.
    pub encoder: EncoderReading,
    /// The current loop's report from its mailbox; the default value for a board without a current loop.
    pub current: CurrentReport,
    /// The command from a person or the computer, if there is one.
    pub command: Option<Command>,
    /// Whether the timer's hardware break has switched the outputs off since
    /// [`ControlOutput::clear_latches`](crate::ControlOutput::clear_latches) was last set.
    pub hardware_break: bool,
    /// Whether the gate driver reports an error.
    pub gate_driver_error: bool,
    /// Whether the board's stop button is pressed.
    pub stop_button: bool,
    /// Whether a whole frame came from the computer since the last control period.
    pub host_heard: bool,
    /// Lateness and duration of the control interrupt, in processor cycles.
    pub timing: TickTiming,
}
