//! The telemetry record of a control tick.

use crate::timing::TickTiming;
use crate::transform::Dq;
use crate::{Amps, Celsius, Volts};
use fixed::types::I16F16;
use touchstone_control::law::Contact;
use touchstone_control::{Energy, Fixed32, Force, Position};
use touchstone_protocol::{Limits, State};

/// One control tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Record {
    /// Number of the tick, wrapping; the first is 1.
    pub tick: u32,
    /// State after the tick.
    pub state: State,
    /// What held the force back.
    pub limits: Limits,
    /// Encoder counts since the calibration, as the law was given them.
    pub count: i64,
    /// Whether the law ran in this tick: armed, and with a good reading.
    pub law_ran: bool,
    /// Penetration `e`, rad; as of the last good reading.
    pub penetration: Position<Fixed32>,
    /// How far the device has moved since the force changed, had all of the change come at once, rad; 0 where that is not measured
    /// ([`crate::change`]).
    pub since_change: Position<Fixed32>,
    /// Force out of the law, N·m.
    pub force: Force<Fixed32>,
    /// The law's offset, rad.
    pub offset: Position<Fixed32>,
    /// The law's observed energy, J; `None` if it observes none.
    pub energy: Option<Energy<Fixed32>>,
    /// Phase of the contact.
    pub contact: Contact,
    /// Wanted torque, along `+x`, N·m: the negative of the force, faded in.
    pub torque: Force<Fixed32>,
    /// Wanted current `i_q`; zero for an analogue drive.
    pub current_command: Amps,
    /// Currents measured.
    pub current: Dq,
    /// Bus voltage.
    pub bus: Volts,
    /// Temperature of the power stage; `None` if its sensor makes no sense.
    pub temperature: Option<Celsius>,
    /// Speed of the shaft, rad/s.
    pub speed_rad_per_s: I16F16,
    /// Cycles of this tick's lateness, and of the tick before.
    pub timing: TickTiming,
}

impl Record {
    /// The state before the first tick.
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
