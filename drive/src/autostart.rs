//! Automatic start: the board calibrates and arms without a desktop when power comes on. It gives the commands that a person would
//! give, and no others.
//!
//! Fault machine and supervisor treat these commands like those from a computer: every limit holds, and the force fades in as after
//! any arming. The board tries once. If a computer sends a frame before the board is armed, the automatic start ends and the
//! computer is in charge.
//!
//! ```text
//! Waiting: supply in its range, shaft at rest -> Checking: calibrate, at rest again -> Started: arm
//! ```
//!
//! The longest time without a frame from the computer (`limits.host_silence_s`) is checked only after the computer's first frame.
//! So after an automatic start a knob runs without a computer, but pulling the cable after a frame has come switches the outputs
//! off. The stop button always works.

use crate::reset::ResetReason;
use touchstone_protocol::{Command, SelfStart, State};

/// Time between two calls of [`Autostart::step`], ms.
pub const STEP_MS: u32 = 10;

/// Steps of 10 ms for which supply and shaft must be in order before the stored alignment is checked: half a second in all.
const REST: u32 = 500 / STEP_MS;
/// Steps of 10 ms for which the shaft must be at rest after the alignment check: a fifth of a second in all.
const REST_AGAIN: u32 = 200 / STEP_MS;
/// Longest time that the board waits for supply and shaft before the alignment check, in steps of 10 ms: ten seconds. After the
/// check it waits at most three seconds.
const PATIENCE: u32 = 10_000 / STEP_MS;
const PATIENCE_AGAIN: u32 = 3_000 / STEP_MS;
/// Encoder counts within which a shaft counts as at rest.
const JITTER: u64 = 4;

/// The board's values that are the inputs of one step of the automatic start.
#[derive(Debug, Clone, Copy)]
pub struct AutostartInput {
    /// State of the device.
    pub state: State,
    /// Whether the supply voltage is within its limits.
    pub is_supplied: bool,
    /// The encoder's count, by which the shaft's rest is judged.
    pub count: i64,
    /// Whether the stop button is pressed.
    pub is_stop_pressed: bool,
    /// Whether a computer has sent a frame since the board started.
    pub desktop_spoke: bool,
}

/// The state of the automatic start, from one step to the next.
#[derive(Debug, Clone, Copy)]
pub struct Autostart {
    told: SelfStart,
    /// Steps of 10 ms in the present phase; `rest`: the number of latest steps in a row in which supply and shaft were in order.
    steps: u32,
    rest: u32,
    /// Encoder count from which the shaft's rest is measured: the count at its last motion.
    count: i64,
}

impl Autostart {
    /// The automatic start at power-up. Whether it begins depends on the setting for autostart, on the reason why the processor
    /// started, and on whether an alignment to check is stored.
    #[must_use]
    pub fn new(is_asked: bool, reason: ResetReason, has_alignment: bool) -> Self {
        let told = if !is_asked {
            SelfStart::Off
        } else if reason != ResetReason::PowerOn {
            SelfStart::NoPowerOn
        } else if !has_alignment {
            SelfStart::NoAlignment
        } else {
            SelfStart::Waiting
        };
        Self {
            told,
            steps: 0,
            rest: 0,
            count: 0,
        }
    }

    /// The present phase of the automatic start, for the report to the computer.
    #[must_use]
    pub const fn told(&self) -> SelfStart {
        self.told
    }

    /// Whether missing frames from the computer are no fault, because the board starts by itself and no computer has sent a frame
    /// since the start.
    #[must_use]
    pub const fn stands_in(&self, desktop_spoke: bool) -> bool {
        matches!(self.told, SelfStart::Checking | SelfStart::Started) && !desktop_spoke
    }

    /// Runs one step of the automatic start (every 10 ms); returns a command for the next control period, if one is due.
    pub fn step(&mut self, now: &AutostartInput) -> Option<Command> {
        let is_first = self.told == SelfStart::Waiting;
        if !is_first && self.told != SelfStart::Checking {
            return None;
        }
        if now.desktop_spoke {
            return self.ends(SelfStart::DesktopSpoke, None);
        }
        let waits_for = match (now.state, is_first) {
            (State::Boot, true) => REST,
            (State::Ready, false) => REST_AGAIN,
            // The command to calibrate has not acted yet, or the calibration runs.
            (State::Boot | State::Calibrating, false) => return None,
            (State::Fault(_), _) => return self.ends(SelfStart::Faulted, None),
            _ => return self.ends(SelfStart::NotReady, None),
        };
        if now.is_stop_pressed {
            return self.ends(SelfStart::StopPressed, Some(Command::Stop));
        }
        self.steps = self.steps.saturating_add(1);
        let is_still = now.count.abs_diff(self.count) <= JITTER;
        if is_still && now.is_supplied {
            self.rest = self.rest.saturating_add(1);
        } else {
            (self.rest, self.count) = (0, now.count);
        }
        if self.rest >= waits_for {
            return if is_first {
                (self.steps, self.rest) = (0, 0);
                self.told = SelfStart::Checking;
                Some(Command::Calibrate)
            } else {
                self.ends(SelfStart::Started, Some(Command::Arm))
            };
        }
        let patience = if is_first { PATIENCE } else { PATIENCE_AGAIN };
        if self.steps >= patience {
            return self.ends(SelfStart::NotReady, Some(Command::Stop));
        }
        None
    }

    fn ends(&mut self, told: SelfStart, command: Option<Command>) -> Option<Command> {
        self.told = told;
        command
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: AutostartInput = AutostartInput {
        state: State::Boot,
        is_supplied: true,
        count: 77,
        is_stop_pressed: false,
        desktop_spoke: false,
    };

    /// The first command that these inputs bring within a minute, and after how many seconds.
    fn first(autostart: &mut Autostart, now: AutostartInput) -> Option<(Command, f64)> {
        let step = |step: u32| {
            let command = autostart.step(&now)?;
            Some((command, f64::from(step * STEP_MS) / 1e3))
        };
        (1..=60_000 / STEP_MS).find_map(step)
    }

    #[test]
    fn it_waits_ten_seconds_for_the_supply_and_three_after_the_check() {
        let dark = AutostartInput {
            is_supplied: false,
            ..GOOD
        };
        let mut autostart = Autostart::new(true, ResetReason::PowerOn, true);
        assert_eq!(first(&mut autostart, dark), Some((Command::Stop, 10.0)));
        assert_eq!(autostart.told(), SelfStart::NotReady);
        // A supply that comes later starts nothing: a person may have a hand at the knob by then.
        assert_eq!(first(&mut autostart, GOOD), None);

        let mut autostart = Autostart::new(true, ResetReason::PowerOn, true);
        let checks = first(&mut autostart, GOOD);
        assert!(
            matches!(checks, Some((Command::Calibrate, _))),
            "{checks:?}"
        );
        let dark = AutostartInput {
            state: State::Ready,
            ..dark
        };
        assert_eq!(first(&mut autostart, dark), Some((Command::Stop, 3.0)));
        assert_eq!(autostart.told(), SelfStart::NotReady);
    }
}
