//! The device's memory from one control period to the next. Supervisor, calibration and control law have memories of their own.

use crate::calibration::Alignment;
use crate::record::Record;
use crate::supervisor::Found;
use touchstone_control::{Fixed32, Position};
use touchstone_protocol::Machine;

/// The memory from which the next control period starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Memory {
    /// State of the device, with a latched fault.
    pub machine: Machine,
    /// Result of the last calibration.
    pub alignment: Alignment,
    /// Count of the unwrapped encoder at the position that the device calls zero.
    pub zero: i64,
    /// Factor by which the torque is multiplied while it fades in, 2^-32.
    pub fade: u32,
    /// A fault that another part of the firmware reported and that the next control period latches; `None` without one.
    pub reported: Option<Found>,
    /// Whether the device refused the settings that it received last.
    pub settings_refused: bool,
    /// The current loop's counter of PWM periods at the voltage limit, as of the last control period.
    pub saturated: u16,
    /// Whether the control law's force was not zero in its last period.
    pub pushes: bool,
    /// Displacement from the last control period's encoder reading to the second reading; `None` without a second reading.
    pub read: Option<Position<Fixed32>>,
    /// The telemetry record of the last control period.
    pub record: Record,
}

impl Memory {
    /// The memory just after power-on.
    pub(super) fn new() -> Self {
        Self {
            machine: Machine::new(),
            alignment: Alignment::default(),
            zero: 0,
            fade: 0,
            reported: None,
            settings_refused: false,
            saturated: 0,
            pushes: false,
            read: None,
            record: Record::empty(),
        }
    }
}
