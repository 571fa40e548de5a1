//! Outputs of a control period.

use crate::command::{DacCode, DriveCommand};
use crate::current::CurrentCommand;
use crate::record::Record;
use touchstone_protocol::Outputs;

/// The actions that the firmware has to take after a control period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ControlOutput {
    /// Whether any output may be on; for `Off` the firmware clears the timer's main output enable. The value is `Off` exactly when
    /// the field `drive` is.
    pub outputs: Outputs,
    /// The command for the current loop or the analogue output; see [`ControlOutput::mailbox`] and [`ControlOutput::analogue`].
    pub drive: DriveCommand,
    /// Whether to clear the timer's break flag, because a command has ended the latched fault.
    pub clear_latches: bool,
    /// Whether a calibration begins with other settings than the last one. The firmware then rebuilds the current loop from
    /// [`crate::Device::current_config`] before the loop's next sample; the bridge is off.
    pub reconfigure: bool,
    /// Whether the command in this period's input had an effect; `None` without a command.
    pub accepted: Option<bool>,
    /// The telemetry record. The firmware also puts it into the [`Ring`](crate::Ring), which is not part of the device, because it
    /// is too large for a stack.
    pub record: Record,
}

impl ControlOutput {
    /// The command for the current loop's mailbox. Even when the motor is to be off, the loop gets a command as a sign of life.
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

    /// The code of the analogue output, and whether the amplifier is enabled.
    #[must_use]
    pub const fn analogue(&self) -> (DacCode, bool) {
        match self.drive {
            DriveCommand::Analogue(code) => (code, true),
            DriveCommand::Off | DriveCommand::Current(_) => (DacCode::ZERO, false),
        }
    }
}
