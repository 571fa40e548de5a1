//! The model beside a device: the same law on the motion that the device measured, tick by tick.
//!
//! A record has penetration and force in full, so the model's force equals the device's bit for bit. That holds as long
//! as every tick's record arrives, and nothing happens between two ticks that no record shows.

use crate::command::{Drive, Rotor};
use crate::config::Config;
use crate::device::torque_of;
use crate::wire::hardware;
use fixed::types::I8F24;
use touchstone_control::law::Contact;
use touchstone_control::{Controller, Fixed32, Force, Position};
use touchstone_protocol::settings::SettingsError;
use touchstone_protocol::{Board, DeviceSettings, Limit, Limits, Phase, Telemetry};

/// How many ticks outside the wall a model needs that did not see how the device was armed: its estimator, whose memory fades away
/// within some periods of its bandwidth, has found the motion again by then.
const FINDS_IN: u32 = 500;

/// How much of the memory of the device's law the model knows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Knows {
    /// The whole run: the model has followed since the tick that armed.
    All,
    /// Too little for a verdict; holds the number of ticks outside the wall so far.
    Little(u32),
}

/// The model.
#[derive(Debug, Clone)]
pub struct Twin {
    config: Config,
    law: Controller<Fixed32>,
    /// The record before: its tick, its state, and whether the law ran in it.
    before: Option<(u32, Phase, bool)>,
    knows: Knows,
    /// Share of the torque while it fades in, 2^-32.
    fade: u32,
    /// The law showed a force in its last tick.
    pushes: bool,
}

impl Twin {
    /// Beside a device with these settings, which calibrated with them.
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

    /// The force of the model in this record's tick; `None` where the device's law does not run, or the model does not know what it
    /// remembers.
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
        // The law does not run in a tick without a good reading.
        if !ran {
            return None;
        }
        // What else there is to touch is in no record.
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

    /// The tick in which the device switches off, as the device does.
    fn leave(&mut self, record: &Telemetry, acted: bool) {
        if acted {
            let _ = self.law_tick(record);
            self.law.commanded(Force::zero());
        }
        self.law.switched_off();
    }

    /// Passes on to the law which force was commanded in the end, as the device does.
    fn becomes_of(&mut self, force: Force<Fixed32>, record: &Telemetry) {
        let limits = Limits::from_wire(record.limits);
        let fading = self.fade < u32::MAX;
        self.fade = self.fade.saturating_add(self.config.fade_step);
        let torque = torque_of(force, fading.then_some(self.fade));
        // By how much a warm power stage was held back is in no record.
        if limits.has(Limit::Temperature) && limits.has(Limit::Current) {
            self.knows = Knows::Little(0);
        }
        // Angles are for the current loop: the torque does not depend on them.
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
        // A flick of a knob that nothing holds begins anew, and where the wall is off, as in the device.
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
