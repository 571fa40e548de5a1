//! Inputs, samples and outputs of the current loop, as plain structs.

use super::Offsets;
use crate::Volts;
use crate::angle::Angle;
use crate::transform::Dq;
use touchstone_protocol::FaultCode;

/// Mode of the bridge until the next control tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(u8)]
pub enum CurrentMode {
    /// The bridge is off: all six switches are open.
    #[default]
    Off = 0,
    /// The bridge is off, and the current sensors' readings without current are measured.
    Offsets = 1,
    /// The bridge is on and holds the command's currents, in the frame that the command's angle gives.
    Drive = 2,
}

/// The command from the control tick to the current loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CurrentCommand {
    /// Number of the control tick. A new number is a sign of life.
    pub tick: u32,
    /// The mode that is commanded.
    pub mode: CurrentMode,
    /// Electrical angle at the time when the encoder was read.
    pub angle: Angle,
    /// Change of the electrical angle in a PWM period, 2^-32 turns.
    pub advance: i32,
    /// Currents to hold, in the rotor's frame, A.
    pub current: Dq,
}

impl CurrentCommand {
    /// The command to be off. Its tick number is 0, which gives no sign of life.
    pub const OFF: Self = Self {
        tick: 0,
        mode: CurrentMode::Off,
        angle: Angle(0),
        advance: 0,
        current: Dq::ZERO,
    };
}

/// The samples of a PWM period.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CurrentSample {
    /// Converter's code for the current of phase A.
    pub phase_a: u16,
    /// Converter's code for the current of phase B.
    pub phase_b: u16,
    /// Converter's code for the bus voltage.
    pub bus: u16,
    /// Converter's code for the power stage's temperature, which is passed on in the report.
    pub temperature: u16,
    /// Whether the timer's break flag is set: the hardware has switched the outputs off.
    pub hardware_break: bool,
    /// Whether the compare values of the period before were written too late for the timer: they act one period later than
    /// intended.
    pub late: bool,
    /// The last command from the control tick's mailbox.
    pub command: CurrentCommand,
}

/// Command to the three-phase bridge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BridgeCommand {
    /// All six switches are open.
    Off,
    /// The bridge is on, with the compare values of phases A, B, C.
    On([u16; 3]),
}

/// The actions that the PWM interrupt has to take next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CurrentOutput {
    /// Command for the bridge's timer.
    pub bridge: BridgeCommand,
    /// Whether a control tick is due: the interrupt then pends the control interrupt.
    pub pend_control: bool,
    /// Whether the encoder is to be read a second time: the control interrupt is then pended for that. Never in the period of a
    /// control tick.
    pub reads_change: bool,
    /// Whether the command is older than two control periods. The firmware then switches off an analogue drive, whose output this
    /// loop does not control.
    pub is_stale: bool,
}

/// Why the current loop switched off without a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Trip {
    /// [`FaultCode::OverCurrent`], [`FaultCode::StaleCommand`], [`FaultCode::HardwareBreak`] or [`FaultCode::DeadlineMiss`].
    pub code: FaultCode,
    /// The trip's value for the fault's context, see [`touchstone_protocol::Context::value`].
    pub value: i32,
}

/// The report from the current loop to the control tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CurrentReport {
    /// PWM periods since the start, wrapping.
    pub periods: u32,
    /// Measured currents in the frame of the command, A; calculated ones on a board that measures none.
    pub current: Dq,
    /// Voltages given to the motor, in the frame of the command, V.
    pub voltage: Dq,
    /// Bus voltage, V.
    pub bus: Volts,
    /// Converter's code for the power stage's temperature.
    pub temperature: u16,
    /// Number of control ticks since the start that were due and brought no command in time, wrapping.
    pub missed: u16,
    /// Number of PWM periods since the start in which the voltage was at its limit, wrapping.
    pub saturated: u16,
    /// Number of trips (switching off without a command), wrapping. A changed number means a new trip.
    pub trips: u8,
    /// The last trip; `None` before the first one.
    pub trip: Option<Trip>,
    /// The current sensors' offsets; `None` until they are measured.
    pub offsets: Option<Offsets>,
}
