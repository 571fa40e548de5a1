//! The alignment that is kept for the next start, and the inputs of an unattended start.

use super::Device;
use crate::calibration::{Alignment, Calibration};
use touchstone_protocol::State;

/// The kept alignment.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Kept {
    /// The alignment at the encoder's own zero.
    alignment: Option<Alignment>,
    /// The last calibration was its check.
    was_checked: bool,
}

impl Device {
    /// Gives the next calibration the alignment at the encoder's zero to check; `None`: it searches for one. The
    /// caller knows that it was measured with the present settings.
    pub const fn keep(&mut self, alignment: Option<Alignment>) {
        self.kept.alignment = alignment;
    }

    /// The alignment in use, at the encoder's zero. `None` unless the device is calibrated with its present settings,
    /// or where the encoder has no zero.
    #[must_use]
    pub fn found(&self) -> Option<Alignment> {
        let config = self.configs.now();
        let is_found = self.memory.machine.state() == State::Ready
            && config.aligns()
            && !self.configs.has_next();
        let zero = self.supervisor.shaft().own_zero(config.supervisor.shaft());
        is_found.then_some(zero?).map(|zero| {
            self.memory
                .alignment
                .from(zero.saturating_neg(), &config.electrical)
        })
    }

    /// Whether the last calibration was the check of a kept alignment.
    #[must_use]
    pub const fn was_checked(&self) -> bool {
        self.kept.was_checked
    }

    /// Whether the last bus voltage is within its limits.
    #[must_use]
    pub fn is_supplied(&self) -> bool {
        let supervisor = &self.configs.now().supervisor;
        supervisor.takes_supply(self.memory.record.bus)
    }

    /// A calibration that begins now is a check, where an alignment is kept. One that measures begins at the beginning.
    #[cold]
    #[inline(never)]
    pub(super) fn begin_with_kept(&mut self) {
        let is_further = self.measurement.is_some() || self.swept.running.is_some();
        if self.calibration.is_some() || is_further {
            return;
        }
        let config = self.configs.now();
        let zero = self.supervisor.shaft().own_zero(config.supervisor.shaft());
        let kept = match (self.kept.alignment, zero) {
            (Some(kept), Some(zero)) if config.aligns() && !config.measurement.wanted => {
                Some(kept.from(zero, &config.electrical))
            }
            _ => None,
        };
        self.kept.was_checked = kept.is_some();
        if let Some(kept) = kept {
            self.calibration = Some(Calibration::of_kept(config.calibration, kept));
        }
    }
}
