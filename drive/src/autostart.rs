//! A board that starts by itself when power comes on. It asks for what a person would ask for, calibrate and arm, and for nothing else.
//!
//! The fault machine and the supervisor know nothing of it: every limit holds as for a command from the desktop, and the force fades in as
//! after any arming. It is tried once. A desktop that speaks before the board is armed has the word: nothing starts by itself any more.
//!
//! ```text
//! Waiting: supply in its range, shaft at rest -> Checking: calibrate, at rest again -> Started: arm
//! ```
//!
//! The silence of a desktop (`limits.host_silence_s`) counts from its first word on: until then the board says that word for it. So a knob without a
//! desktop runs, and a cable that is pulled in a session switches off as ever. The stop button holds always.

use crate::reset::ResetReason;
use touchstone_protocol::{Command, SelfStart, State};

/// A step is to be made so often, ms.
pub const STEP_MS: u32 = 10;

/// Supply and shaft must be in order for this many steps: half a second.
const REST: u32 = 500 / STEP_MS;
/// Time at rest after the check: a fifth of a second.
const REST_AGAIN: u32 = 200 / STEP_MS;
/// The board waits this many steps for supply and shaft: ten seconds, and three after the check.
const PATIENCE: u32 = 10_000 / STEP_MS;
const PATIENCE_AGAIN: u32 = 3_000 / STEP_MS;
/// Counts that a shaft at rest may jitter.
const JITTER: u64 = 4;

/// Inputs of one step.
#[derive(Debug, Clone, Copy)]
pub struct Glance {
    /// State of the device.
    pub state: State,
    /// The supply is within its limits.
    pub is_supplied: bool,
    /// The encoder's count.
    pub count: i64,
    /// The stop button is pressed.
    pub is_stop_pressed: bool,
    /// A desktop has spoken since the start.
    pub desktop_spoke: bool,
}

/// The unattended start.
#[derive(Debug, Clone, Copy)]
pub struct Autostart {
    told: SelfStart,
    /// Steps in this phase, and how many of them were in order.
    steps: u32,
    rest: u32,
    /// Where the shaft rests.
    count: i64,
}

impl Autostart {
    /// The state at power-up, given whether autostart is on, why the processor started, and whether there is an
    /// alignment to check.
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

    /// State of the unattended start so far.
    #[must_use]
    pub const fn told(&self) -> SelfStart {
        self.told
    }

    /// Whether a word is to be said in place of a desktop that never spoke.
    #[must_use]
    pub const fn stands_in(&self, desktop_spoke: bool) -> bool {
        matches!(self.told, SelfStart::Checking | SelfStart::Started) && !desktop_spoke
    }

    /// A step: a command for the next control tick.
    pub fn step(&mut self, now: &Glance) -> Option<Command> {
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
            // The command is on its way, or carried out.
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
