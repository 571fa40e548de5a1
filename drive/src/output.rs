//! Outputs of a control tick.

use crate::command::{DacCode, DriveCommand};
use crate::current::CurrentCommand;
use crate::record::Record;
use touchstone_protocol::Outputs;

/// The actions of the firmware after a control tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControlOutput {
    /// Whether anything may be on at all; `Off` clears the main output enable. `Off` exactly when `drive` is.
    pub outputs: Outputs,
    /// For the current loop or the analogue output, see [`ControlOutput::mailbox`] and [`ControlOutput::analogue`].
    pub drive: DriveCommand,
    /// Clear the timer's break flag: the fault was left by command.
    pub clear_latches: bool,
    /// The settings of this calibration differ from the last one's: rebuild the current loop from [`crate::Device::current_config`]
    /// before its next sample. The bridge is off.
    pub reconfigure: bool,
    /// Whether the command of this tick had an effect; `None` without one.
    pub accepted: Option<bool>,
    /// The telemetry record; also for the [`Ring`](crate::Ring), which is no part of the device: it is too large for a stack.
    pub record: Record,
}

impl ControlOutput {
    /// The current loop's mailbox: also when nothing is to move it gets a command, as a sign of life.
    #[must_use]
    pub const fn mailbox(&self) -> CurrentCommand {
        match self.drive {
            DriveCommand::Current(command) => command,
            DriveCommand::Off | DriveCommand::Analogue(_) => CurrentCommand {
                tick: self.record.tick,
                ..CurrentCommand::OFF
            },
        }
    }

    /// The analogue output, and whether the amplifier is enabled.
    #[must_use]
    pub const fn analogue(&self) -> (DacCode, bool) {
        match self.drive {
            DriveCommand::Analogue(code) => (code, true),
            DriveCommand::Off | DriveCommand::Current(_) => (DacCode::ZERO, false),
        }
    }
}
