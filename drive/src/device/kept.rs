//! The device's stored alignment (encoder count to electrical angle), and the values that an automatic start needs.

use super::Device;
use crate::calibration::{Alignment, Calibration};
use touchstone_protocol::State;

/// The stored alignment of an absolute encoder: the electrical angle at its own zero.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Kept {
    /// The stored alignment, relative to the encoder's own zero; `None` if none is stored.
    alignment: Option<Alignment>,
    /// Whether the last calibration was a check of the stored alignment.
    was_checked: bool,
}

impl Device {
    /// Sets the stored alignment, relative to the encoder's own zero, that the next calibration checks. With `None` that
    /// calibration measures a new alignment. The caller ensures that the stored one was measured with the present settings.
    pub const fn keep(&mut self, alignment: Option<Alignment>) {
        self.kept.alignment = alignment;
    }

    /// The alignment in use, relative to the encoder's own zero. `None` unless the device is ready and calibrated with its present
    /// settings, and the encoder has its own zero.
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

    /// Whether the last calibration was the check of a stored alignment.
    #[must_use]
    pub const fn was_checked(&self) -> bool {
        self.kept.was_checked
    }

    /// Whether the bus voltage was within its limits in the last control period.
    #[must_use]
    pub fn is_supplied(&self) -> bool {
        let supervisor = &self.configs.now().supervisor;
        supervisor.takes_supply(self.memory.record.bus)
    }

    /// Begins a calibration. If an alignment is stored, the calibration checks that alignment; but a calibration that also
    /// measures the motor finds a new one.
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
