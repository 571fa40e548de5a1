//! The memory of the control tick. Supervisor, calibration and law have their own.

use crate::calibration::Alignment;
use crate::record::Record;
use crate::supervisor::Found;
use touchstone_control::{Fixed32, Position};
use touchstone_protocol::Machine;

/// The memory that the next tick starts from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Memory {
    /// State of the device.
    pub machine: Machine,
    /// Result of the last calibration.
    pub alignment: Alignment,
    /// Count of the unwrapped encoder that is the device's zero.
    pub zero: i64,
    /// Share of the torque while it fades in, 2^-32.
    pub fade: u32,
    /// A fault that another part saw, for the next tick.
    pub reported: Option<Found>,
    /// The settings that came last were refused.
    pub settings_refused: bool,
    /// The current loop's count of periods at its voltage limit.
    pub saturated: u16,
    /// The law showed a force in its last tick.
    pub pushes: bool,
    /// How far the device had moved when the force changed since the last tick.
    pub read: Option<Position<Fixed32>>,
    /// The last tick's record.
    pub record: Record,
}

impl Memory {
    /// The state just after power-on.
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
