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
    /// Off: all six switches open.
    #[default]
    Off = 0,
    /// Off; the sensors' readings without current are measured.
    Offsets = 1,
    /// Switched on, with the currents of the command in the frame of the command.
    Drive = 2,
}

/// The mailbox from the control tick to the current loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CurrentCommand {
    /// Number of the control tick: a new number is a sign of life.
    pub tick: u32,
    /// The mode that is commanded.
    pub mode: CurrentMode,
    /// Electrical angle when the encoder was read.
    pub angle: Angle,
    /// How far the angle moves in a PWM period, 2^-32 turns.
    pub advance: i32,
    /// Currents to hold.
    pub current: Dq,
}

impl CurrentCommand {
    /// Off, without a sign of life.
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
    /// Converter's code of the current of phase A.
    pub phase_a: u16,
    /// Reading of phase B's sensor.
    pub phase_b: u16,
    /// Reading of the bus voltage.
    pub bus: u16,
    /// Reading of the power stage's temperature, which is passed on.
    pub temperature: u16,
    /// The timer's break flag is set: the hardware has switched off.
    pub hardware_break: bool,
    /// The compare values of the period before came after the timer's turn: they act a period later than they were made for.
    pub late: bool,
    /// The mailbox.
    pub command: CurrentCommand,
}

/// Command to the bridge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BridgeCommand {
    /// All six switches open.
    Off,
    /// Compare values of phases A, B, C.
    On([u16; 3]),
}

/// The actions that the interrupt has to take next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CurrentOutput {
    /// Command for the timer.
    pub bridge: BridgeCommand,
    /// A control tick is due: pend its interrupt.
    pub pend_control: bool,
    /// The encoder is to be read a second time: the interrupt is pended for that. Never together with a tick.
    pub reads_change: bool,
    /// The command is older than two control periods: an analogue drive, whose output this loop does not make, is switched off.
    pub is_stale: bool,
}

/// Why the loop switched off without a command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Trip {
    /// [`FaultCode::OverCurrent`], [`FaultCode::StaleCommand`], [`FaultCode::HardwareBreak`] or [`FaultCode::DeadlineMiss`].
    pub code: FaultCode,
    /// Same as [`touchstone_protocol::Context::value`].
    pub value: i32,
}

/// The mailbox from the current loop to the control tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CurrentReport {
    /// PWM periods since the start, wrapping.
    pub periods: u32,
    /// Measured currents in the frame of the command; computed ones on a board that measures none.
    pub current: Dq,
    /// Voltages given, same frame.
    pub voltage: Dq,
    /// Bus voltage.
    pub bus: Volts,
    /// Converter's code of the temperature.
    pub temperature: u16,
    /// Control ticks that were due and brought no command in time, since the start, wrapping.
    pub missed: u16,
    /// Periods in which the voltage was at its limit, since the start, wrapping.
    pub saturated: u16,
    /// How often the loop tripped, wrapping: a change is a new trip.
    pub trips: u8,
    /// The last trip.
    pub trip: Option<Trip>,
    /// The sensors' offsets, once measured.
    pub offsets: Option<Offsets>,
}
