//! One period of the control law, and how its force becomes a drive command.

use super::Device;
use crate::command::{Drive, DriveCommand, Driven};
use crate::scenery::{Here, Scenery};
use crate::units::product;
use fixed::types::I8F24;
use touchstone_control::law::Contact;
use touchstone_control::{Fixed32, Force, Position};
use touchstone_protocol::{FaultCode, Limit, Limits};

impl Device {
    /// Stores in the telemetry record the displacement since the last change of force. The value stays 0 if the position at the
    /// change is not measured.
    pub(super) fn since_change(
        &mut self,
        last: (Position<Fixed32>, i64),
        read: Option<Position<Fixed32>>,
        scenery: &impl Scenery,
    ) {
        let config = self.configs.now();
        if let (Some(change), Some(until)) = (&config.change, read) {
            let record = &mut self.memory.record;
            // For an environment the displacement is calculated from counts, which also cover angles beyond the range of
            // positions, and have the same step in every turn.
            let moved = if scenery.runs() {
                config.scale.moved(record.count.saturating_sub(last.1))
            } else {
                record.penetration - last.0
            };
            record.since_change = change.since_change(until, moved - until);
        }
    }

    #[inline(always)]
    fn here(&self) -> Here {
        let measures = self.configs.now().change.is_some();
        Here {
            count: self.memory.record.count,
            penetration: self.memory.record.penetration,
            since_change: measures.then_some(self.memory.record.since_change),
        }
    }

    /// Handles the control period in which the outputs are switched off. If `acted` is true, the last force acted over the
    /// displacement up to now, and the energy guard accounts for that displacement. Otherwise the guard assumes the worst case.
    #[cold]
    pub(super) fn leave(
        &mut self,
        acted: bool,
        last: (Position<Fixed32>, i64),
        read: Option<Position<Fixed32>>,
        scenery: &mut impl Scenery,
    ) {
        if acted {
            self.since_change(last, read, scenery);
            let here = self.here();
            // The outputs are off and the next arming clears the control law's memory, so the law's force does not matter.
            let _ = scenery.tick(&mut self.law, &self.configs.now().scale, &here);
            scenery.commanded(&mut self.law, Force::zero());
        }
        scenery.switched_off(&mut self.law);
    }

    /// Runs one period of the control law, and turns its force into a drive command.
    pub(super) fn display(
        &mut self,
        tick: u32,
        derating: u32,
        count: Option<i64>,
        scenery: &mut impl Scenery,
    ) -> (DriveCommand, Limits) {
        let here = self.here();
        let force = scenery.tick(&mut self.law, &self.configs.now().scale, &here);
        let view = scenery.view(&self.law);
        let fading = self.memory.fade < u32::MAX;
        let step = self.configs.now().fade_step;
        let share = self.memory.fade.saturating_add(step);
        self.memory.fade = share;
        let torque = torque_of(force, fading.then_some(share));

        #[cfg_attr(not(feature = "large"), allow(unused_mut))]
        let mut rotor = self.rotor(tick, count.unwrap_or_default(), derating);
        #[cfg(feature = "large")]
        {
            rotor.map = shared(self.map_here(scenery), fading.then_some(share));
        }
        let driven = self.configs.now().drive.command(torque, &rotor);
        if fading || driven.torque != torque {
            let torque = driven.torque.0.to_bits().saturating_neg();
            scenery.commanded(&mut self.law, Force(I8F24::from_bits(torque)));
        }
        let pushed = core::mem::replace(&mut self.memory.pushes, force != Force::zero());
        let is_tripped = scenery.is_tripped(&self.law);
        // Beyond its reach the single wall is off only once its energy guard has tripped.
        let beyond_reach =
            (is_tripped || scenery.runs()) && scenery.is_beyond_reach(&self.law, here.penetration);
        if is_tripped {
            if beyond_reach && !scenery.runs() {
                // The single wall gives no force at this depth, which is no fault. The energy that the last force may still give
                // is taken from the energy guard's account.
                scenery.switched_off(&mut self.law);
                scenery.again(&mut self.law, &self.configs.now().law);
            } else if pushed || view.contact != Contact::Free {
                let speed = self.memory.record.speed_rad_per_s;
                self.report_fault(FaultCode::OverSpeed, crate::units::milli(speed));
            } else {
                // A free knob turned too fast. No force acted meanwhile, so nothing need be taken from the energy guard's
                // account.
                scenery.again(&mut self.law, &self.configs.now().law);
            }
        }
        let Driven {
            command: drive,
            limits,
            ..
        } = driven;
        let record = &mut self.memory.record;
        record.law_ran = true;
        record.force = force;
        record.torque = driven.torque;
        record.offset = view.offset;
        record.energy = view.energy;
        record.contact = view.contact;
        let full = force.modulus().0 >= self.configs.now().force_limit;
        (
            drive,
            limits
                .with(Limit::FadeIn, fading)
                .with(Limit::Force, full)
                .with(Limit::Beside, scenery.runs())
                .with(Limit::Reach, beyond_reach),
        )
    }
}

/// The cogging map's current, multiplied by the fade-in fraction as in [`torque_of`].
#[cfg(feature = "large")]
#[inline(always)]
fn shared(map: crate::Amps, share: Option<u32>) -> crate::Amps {
    share.map_or(map, |share| {
        crate::Amps::from_bits(product(map.to_bits(), (share >> 1).cast_signed(), 31))
    })
}

/// Converts a force (positive against rising positions) to a torque (positive towards rising positions). While the force fades
/// in, it is multiplied by the fraction `share`, in 2^-32; `None` gives the whole force.
#[inline(always)]
#[must_use]
pub fn torque_of(force: Force<Fixed32>, share: Option<u32>) -> Force<Fixed32> {
    let bits = force.0.to_bits();
    let faded = share.map_or(bits, |share| product(bits, (share >> 1).cast_signed(), 31));
    Force(I8F24::from_bits(faded.saturating_neg()))
}
