//! Checks the stop button, and the time since the computer's last frame. So a person can switch the device off by pressing the
//! button or by pulling the cable.

use super::Found;
use crate::input::ControlInput;
use crate::units::clamp_i32;
use touchstone_control::Si;
use touchstone_protocol::{DeviceSettings, FaultCode};

/// Coefficients of the checks of stop button and computer.
#[derive(Debug, Clone, Copy)]
pub struct AskedConfig {
    /// Number of control periods without a frame from the computer that are a fault; 0 if missing frames are allowed.
    silent: u32,
    rate_hz: u32,
}

impl AskedConfig {
    /// Computes the coefficients of the checks from validated settings.
    #[must_use]
    #[inline]
    pub fn new(settings: &DeviceSettings) -> Self {
        let rate_hz = settings.timing.rate_hz.max(1);
        let ticks = settings
            .limits
            .host_silence_s
            .saturating_mul(Si::saturating_from_num(rate_hz));
        Self {
            silent: ticks.saturating_ceil().saturating_to_num(),
            rate_hz,
        }
    }
}

/// The time since the computer's last frame, in control periods.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Asked {
    ticks: u32,
}

impl Asked {
    /// The state just after a frame from the computer.
    #[must_use]
    pub const fn new() -> Self {
        Self { ticks: 0 }
    }

    /// Checks a control period; returns the fault, if there is one. The time since the last frame counts only while the outputs may
    /// be on.
    pub fn update(
        &mut self,
        config: &AskedConfig,
        input: &ControlInput,
        may_be_on: bool,
    ) -> Option<Found> {
        self.ticks = if input.host_heard || !may_be_on {
            0
        } else {
            self.ticks.saturating_add(1)
        };
        if input.stop_button {
            return Some((FaultCode::StopButton, 0));
        }
        let is_gone = config.silent != 0 && self.ticks >= config.silent;
        is_gone.then(|| {
            let ms = (u64::from(self.ticks) * 1_000).checked_div(u64::from(config.rate_hz));
            let ms = ms.and_then(|ms| i64::try_from(ms).ok());
            (FaultCode::HostSilent, clamp_i32(ms.unwrap_or(i64::MAX)))
        })
    }
}
