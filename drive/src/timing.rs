//! Duration and lateness of a control interrupt in processor cycles, and the length of a control period in PWM periods.

use crate::hardware::Hardware;
use touchstone_protocol::DeviceSettings;

/// Timing of a control interrupt, as the firmware measured it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TickTiming {
    /// Processor cycles from the time at which the control interrupt was due to its first instruction.
    pub lateness: u32,
    /// Processor cycles of the previous control interrupt, from its first instruction to its last; 0 for the first one.
    pub duration: u32,
}

/// Number of PWM periods in a control period.
#[must_use]
#[inline]
pub fn periods_per_tick(settings: &DeviceSettings, hardware: &Hardware) -> u16 {
    let periods = hardware
        .pwm_hz
        .checked_div(settings.timing.rate_hz)
        .unwrap_or(1);
    u16::try_from(periods).unwrap_or(u16::MAX).max(1)
}
