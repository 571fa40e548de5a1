//! The telemetry record of a control period.

use crate::timing::TickTiming;
use crate::transform::Dq;
use crate::{Amps, Celsius, Volts};
use fixed::types::I16F16;
use touchstone_control::law::Contact;
use touchstone_control::{Energy, Fixed32, Force, Position};
use touchstone_protocol::{Limits, State};

/// The telemetry values of one control period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Record {
    /// Number of the control period, wrapping at 2^32; the first one is 1.
    pub tick: u32,
    /// State of the device after the control period.
    pub state: State,
    /// The limits that act in this period.
    pub limits: Limits,
    /// Encoder count relative to the zero, which is set at a calibration and by [`crate::Device::zero_here`].
    pub count: i64,
    /// Whether the control law ran in this period: the device was armed, and the encoder reading was good.
    pub law_ran: bool,
    /// Penetration `e` into the wall at the last good encoder reading, rad.
    pub penetration: Position<Fixed32>,
    /// Displacement since the force changed, as if the whole change had come at one instant, rad; 0 if that is not measured
    /// ([`crate::change`]).
    pub since_change: Position<Fixed32>,
    /// Force that the control law returned after its energy guard, N·m.
    pub force: Force<Fixed32>,
    /// Offset of the control law's virtual spring, rad.
    pub offset: Position<Fixed32>,
    /// Energy that the control law's own passivity observer has summed, J; `None` if the law has no observer.
    pub energy: Option<Energy<Fixed32>>,
    /// Phase of the contact with the wall.
    pub contact: Contact,
    /// Torque that remains after the fade-in and the current limit, N·m, positive towards rising positions (the force is positive
    /// against them).
    pub torque: Force<Fixed32>,
    /// Requested current `i_q`, A; zero for an analogue drive.
    pub current_command: Amps,
    /// Measured currents in the rotor's frame, A.
    pub current: Dq,
    /// Bus voltage, V.
    pub bus: Volts,
    /// Temperature of the power stage; `None` if the sensor's reading is impossible.
    pub temperature: Option<Celsius>,
    /// Speed of the shaft, rad/s.
    pub speed_rad_per_s: I16F16,
    /// Lateness of this period's control interrupt, and running time of the previous period's interrupt, in processor cycles.
    pub timing: TickTiming,
}

impl Record {
    /// The record before the first control period.
    #[must_use]
    pub fn empty() -> Self {
        Self {
            tick: 0,
            state: State::Boot,
            limits: Limits::NONE,
            count: 0,
            law_ran: false,
            penetration: Position::zero(),
            since_change: Position::zero(),
            force: Force::zero(),
            offset: Position::zero(),
            energy: None,
            contact: Contact::Free,
            torque: Force::zero(),
            current_command: Amps::ZERO,
            current: Dq::ZERO,
            bus: Volts::ZERO,
            temperature: None,
            speed_rad_per_s: I16F16::ZERO,
            timing: TickTiming::default(),
        }
    }
}
