//! A model that runs beside a device: the same control law, fed in each control period with the motion that the device measured.
//!
//! A telemetry record holds penetration and force with all bits, so the model's force equals the device's force bit for bit. That
//! holds as long as every record arrives, and everything that influences the force is in the records.

use crate::command::{Drive, Rotor};
use crate::config::Config;
use crate::device::torque_of;
use crate::wire::hardware;
use fixed::types::I8F24;
use touchstone_control::law::Contact;
use touchstone_control::{Controller, Fixed32, Force, Position};
use touchstone_protocol::settings::SettingsError;
use touchstone_protocol::{Board, DeviceSettings, Limit, Limits, Phase, Telemetry};

/// Number of control periods outside the wall after which forces are compared, if the model's records do not begin with the
/// arming. The memory of the law's state estimator fades within some periods of the estimator's bandwidth, so the estimate is
/// right by then.
const FINDS_IN: u32 = 500;

/// Whether the copy has the whole memory of the device's control law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Knows {
    /// The law's whole memory: the copy has run since the device was armed.
    All,
    /// Too little of the law's memory for a comparison of forces. Holds the number of control periods that the knob has been
    /// outside the wall.
    Little(u32),
}

/// A copy of the device's control law. It calculates the force from the device's records, for comparison with the device's force.
#[derive(Debug, Clone)]
pub struct Twin {
    config: Config,
    law: Controller<Fixed32>,
    /// Values of the previous record: its number, the device's state, and whether the control law ran.
    before: Option<(u32, Phase, bool)>,
    knows: Knows,
    /// Factor by which the torque is multiplied while it fades in, 2^-32.
    fade: u32,
    /// Whether the control law's force was not zero in its last period.
    pushes: bool,
}

impl Twin {
    /// Makes a model for a device that calibrated with these settings.
    ///
    /// # Errors
    /// Same as [`Config::new`].
    pub fn new(settings: &DeviceSettings, board: Board) -> Result<Self, SettingsError> {
        let config = Config::new(settings, hardware(board))?;
        Ok(Self {
            config,
            law: config.law,
            before: None,
            knows: Knows::Little(0),
            fade: u32::MAX,
            pushes: false,
        })
    }

    /// The model's force in the control period of this record. `None` if the device's control law does not run, or if the copy
    /// does not have the law's memory.
    pub fn tick(&mut self, record: &Telemetry) -> Option<I8F24> {
        let limits = Limits::from_wire(record.limits);
        let has_reading = !limits.has(Limit::Encoder);
        let ran = record.phase == Phase::Armed && has_reading;
        let before = self.before.replace((record.tick, record.phase, ran));
        let follows = before.is_some_and(|(tick, ..)| record.tick == tick.wrapping_add(1));
        let was_armed = before.is_some_and(|(_, phase, _)| phase == Phase::Armed);
        if record.phase != Phase::Armed {
            if was_armed {
                let ran = follows && before.is_some_and(|(.., ran)| ran);
                self.leave(record, ran && has_reading && record.phase != Phase::Fault);
            }
            return None;
        }
        if !was_armed || !follows {
            self.law.resume(&self.config.law);
            self.pushes = false;
            let sees_it_armed = follows && !was_armed;
            self.fade = if sees_it_armed { 0 } else { u32::MAX };
            self.knows = if sees_it_armed {
                Knows::All
            } else {
                Knows::Little(0)
            };
        }
        // The control law does not run in a control period without a good encoder reading.
        if !ran {
            return None;
        }
        // The records do not hold an environment (further walls, detents), so its forces cannot be computed.
        if limits.has(Limit::Beside) {
            self.knows = Knows::Little(0);
            return None;
        }
        let force = self.law_tick(record);
        self.becomes_of(force, record);
        if let Knows::Little(outside) = &mut self.knows {
            let is_outside = record.penetration_rad <= 0 && !limits.has(Limit::FadeIn);
            *outside = if is_outside {
                outside.saturating_add(1)
            } else {
                0
            };
            if *outside < FINDS_IN {
                return None;
            }
            self.knows = Knows::All;
        }
        Some(force.0)
    }

    fn law_tick(&mut self, record: &Telemetry) -> Force<Fixed32> {
        let now = Position(record.penetration_rad);
        let at_change = now - Position(record.since_change_rad);
        let measures = self.config.change.is_some();
        self.law
            .tick_with_change(now, measures.then_some(at_change))
    }

    /// Handles, as the device does, the control period in which the device switches its outputs off.
    fn leave(&mut self, record: &Telemetry, acted: bool) {
        if acted {
            let _ = self.law_tick(record);
            self.law.commanded(Force::zero());
        }
        self.law.switched_off();
    }

    /// Reports to the control law, as the device does, the force that was finally commanded.
    fn becomes_of(&mut self, force: Force<Fixed32>, record: &Telemetry) {
        let limits = Limits::from_wire(record.limits);
        let fading = self.fade < u32::MAX;
        self.fade = self.fade.saturating_add(self.config.fade_step);
        let torque = torque_of(force, fading.then_some(self.fade));
        // The records do not say by how much a warm power stage or motor reduced the force.
        if limits.has(Limit::Temperature) && limits.has(Limit::Current) {
            self.knows = Knows::Little(0);
        }
        // Only the current loop needs the angles; the torque does not depend on them.
        let rotor = Rotor {
            derating: 1 << 16,
            ..Rotor::default()
        };
        let driven = self.config.drive.command(torque, &rotor);
        if fading || driven.torque != torque {
            self.law.commanded(Force(I8F24::from_bits(
                driven.torque.0.to_bits().saturating_neg(),
            )));
        }
        // As in the device, the control law restarts after a fast motion of a free knob, and beyond the reach of the wall.
        let pushed = core::mem::replace(&mut self.pushes, force != Force::zero());
        let is_free = self.law.view().contact == Contact::Free;
        if self.law.tripped() {
            let beyond_reach = self.law.is_beyond_reach(Position(record.penetration_rad));
            if beyond_reach {
                self.law.switched_off();
            }
            if beyond_reach || !pushed && is_free {
                self.law.resume(&self.config.law);
            }
        }
    }
}
