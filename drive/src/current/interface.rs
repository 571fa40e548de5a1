//! Inputs, samples and outputs of the current loop, as plain structs.

use super::Offsets;
use crate::Volts;
use crate::angle::Angle;
use crate::transform::Dq;
use touchstone_protocol::FaultCode;

/// Mode of the bridge until the next control period.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(u8)]
pub enum CurrentMode {
    /// The bridge is off: all six switches are open.
    #[default]
    Off = 0,
    /// The bridge is off, and the current sensors' readings at zero current (offsets) are measured.
    Offsets = 1,
    /// The bridge is on. The loop holds the command's currents, in a frame at the command's electrical angle.
    Drive = 2,
}

/// The command from the control interrupt to the current loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CurrentCommand {
    /// Number of the control period. A new number is a sign of life.
    pub tick: u32,
    /// The mode of the bridge.
    pub mode: CurrentMode,
    /// Electrical angle at the time when the encoder was read.
    pub angle: Angle,
    /// Change of the electrical angle in a PWM period, 2^-32 turns.
    pub advance: i32,
    /// Currents to hold, in the rotor's frame, A.
    pub current: Dq,
}

impl CurrentCommand {
    /// The command to switch the bridge off. Its number of the control period is 0, which gives no sign of life.
    pub const OFF: Self = Self {
        tick: 0,
        mode: CurrentMode::Off,
        angle: Angle(0),
        advance: 0,
        current: Dq::ZERO,
    };
}

/// The samples that the current loop gets in a PWM period.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CurrentSample {
    /// Code of the analogue-to-digital converter for the current of phase A.
    pub phase_a: u16,
    /// Code of the analogue-to-digital converter for the current of phase B.
    pub phase_b: u16,
    /// Code of the analogue-to-digital converter for the bus voltage.
    pub bus: u16,
    /// Code of the analogue-to-digital converter for the power stage's temperature. The loop only passes it on in its report.
    pub temperature: u16,
    /// Whether the timer's break flag is set: the hardware has switched the outputs off.
    pub hardware_break: bool,
    /// Whether the previous PWM period's compare values were written too late for the timer. They then act one period later than
    /// intended.
    pub late: bool,
    /// The last command in the mailbox from the control interrupt.
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

/// The actions that the PWM interrupt has to take after a call of the current loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CurrentOutput {
    /// Command for the bridge's timer.
    pub bridge: BridgeCommand,
    /// Whether a control period begins: the PWM interrupt then pends the control interrupt.
    pub pend_control: bool,
    /// Whether to read the encoder a second time: the PWM interrupt then pends the control interrupt for that. Never true in a PWM
    /// period in which a control period begins.
    pub reads_change: bool,
    /// Whether the command is older than two control periods. The firmware then switches off an analogue drive, whose output this
    /// loop does not control.
    pub is_stale: bool,
}

/// Why the current loop switched the bridge off without a command to do so (a trip).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Trip {
    /// The reason as a fault code: [`FaultCode::OverCurrent`], [`FaultCode::StaleCommand`], [`FaultCode::HardwareBreak`] or
    /// [`FaultCode::DeadlineMiss`].
    pub code: FaultCode,
    /// Value of the fault that the trip causes, see [`touchstone_protocol::Context::value`].
    pub value: i32,
}

/// The report from the current loop to the control interrupt.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CurrentReport {
    /// PWM periods since the start, wrapping.
    pub periods: u32,
    /// Measured currents in the command's d, q frame, A. A board that measures no current calculates them.
    pub current: Dq,
    /// Voltages given to the motor, in the command's d, q frame, V.
    pub voltage: Dq,
    /// Bus voltage, V.
    pub bus: Volts,
    /// Code of the analogue-to-digital converter for the power stage's temperature.
    pub temperature: u16,
    /// Number of control periods since the start that were due but brought no command in time, wrapping.
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
