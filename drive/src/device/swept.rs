//! A calibration followed by a cogging sweep (a slow turn that measures the cogging torque), and the map with which the board
//! compensates cogging.

use super::Device;
use crate::Amps;
use crate::around::Around;
use crate::calibration::{Progress, failed};
use crate::cogging::Played;
use crate::measurement::Measuring;
use crate::scenery::Scenery;
use crate::sweep::Running;
use touchstone_protocol::{State, Sweep};

/// The cogging sweep requested for the next calibration, and the state of a running sweep.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Swept {
    wanted: Sweep,
    pub(super) running: Option<Running>,
}

impl Device {
    /// Requests a cogging sweep for the next calibration.
    pub const fn sweep(&mut self, sweep: Sweep) {
        self.swept.wanted = sweep;
    }

    /// Sets the cogging map with which the board compensates cogging; `None` for no map. The map must have been computed with the
    /// settings that [`Device::prepare`] got last. If these settings wait for a calibration, no map is used until then.
    pub fn play(&self, around: &mut Around, map: Option<&Played>) {
        around.play(map, self.configs.has_next());
    }

    /// The cogging map's current at the shaft's present position.
    #[inline(always)]
    pub(super) fn map_here(&self, scenery: &impl Scenery) -> Amps {
        let Some(played) = scenery.played() else {
            return Amps::ZERO;
        };
        let config = self.configs.now().supervisor.shaft();
        let shaft = self.supervisor.shaft();
        let place = shaft.from_own_zero(config);
        place.map_or(Amps::ZERO, |place| {
            played.current(place, shaft.speed(config))
        })
    }

    /// Whether a cogging sweep is requested and has not begun.
    pub(super) fn begins_sweep(&self) -> bool {
        self.swept.wanted != Sweep::None && self.swept.running.is_none()
    }

    /// Runs one control period of a cogging sweep; the first one uses the alignment that was just found. During a sweep the
    /// reported position is measured from the encoder's own zero.
    #[cold]
    #[inline(never)]
    pub(super) fn swept(&mut self, tick: u32, count: i64, map: Amps) -> Progress {
        let config = self.configs.now();
        let shaft = self.supervisor.shaft();
        let speed = shaft.speed(config.supervisor.shaft());
        let own_zero = shaft.own_zero(config.supervisor.shaft());
        let sweep = config.sweep;
        let rotor = self.rotor(tick, count, 1 << 16);
        // The zero is set only in the first control period, because the encoder's own reading wraps at each turn.
        if let (None, Some(own_zero)) = (&self.swept.running, own_zero) {
            self.memory.zero = own_zero.saturating_neg();
        }
        let map = match self.swept.wanted {
            Sweep::Compensated => map,
            Sweep::None | Sweep::Bare => Amps::ZERO,
        };
        let running = self
            .swept
            .running
            .get_or_insert_with(|| Running::new(sweep, count));
        match running.tick(count, speed, &rotor, map) {
            Measuring::Running(command) => Progress::Running(command),
            Measuring::Done => Progress::Done(self.memory.alignment),
            Measuring::Failed(reason) => failed(reason),
        }
    }

    /// Ends a cogging sweep when the device leaves the state `before`: a request holds for one calibration only.
    pub(super) fn leave_sweep(&mut self, before: State) {
        self.swept.running = None;
        if before == State::Calibrating {
            self.swept.wanted = Sweep::None;
        }
    }
}
