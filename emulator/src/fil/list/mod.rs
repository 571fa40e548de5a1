//! The list of fault injections, each with the state of the device, the moment and the expected result.

mod as5047p;
mod asked;
mod beside;
mod esc1;
mod g431rb;
mod ihm16m1;
mod others;
mod power;
mod processor;
mod second;
mod simplefoc_mini;

use touchstone_protocol::FaultCode as Code;

use super::fault::Fault;

pub use as5047p::WITH_AS5047P;
pub use asked::ASKED_FOR;
pub use beside::BESIDE;
pub use esc1::ON_ESC1;
pub use g431rb::ON_G431RB;
pub use ihm16m1::{MORE_ON_IHM16M1, ON_IHM16M1, WITH_LINK_R35};
pub use others::{WITH_MT6701, WITH_TRACKS};
pub use power::POWER;
pub use processor::PROCESSOR;
pub use second::SECOND;
pub use simplefoc_mini::ON_SIMPLEFOC_MINI;

/// The state of the device in which the fault happens.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum When {
    /// The device is calibrated and its outputs are off.
    Ready,
    /// The device is stopped; a calibration is requested after the fault has happened.
    Starting,
    /// The device measures the offsets of its current sensors without current, with its outputs off.
    Measuring,
    /// The device calibrates: the motor's field turns the shaft.
    Calibrating,
    /// The device is armed and the knob is outside of the wall.
    Free,
    /// The device is armed and a hand presses the knob into the wall.
    Pressed,
}

impl When {
    /// Whether the motor outputs are on in this state.
    #[must_use]
    pub const fn is_on(self) -> bool {
        !matches!(self, Self::Ready | Self::Starting | Self::Measuring)
    }
}

/// The result that an injection must have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Expect {
    /// The outputs are off within this many microseconds, and one of these fault codes is latched.
    Off(u64, &'static [Code]),
    /// Within this many microseconds the outputs are off and stay off; before that they may switch. One of these fault codes is
    /// latched.
    OffAtLast(u64, &'static [Code]),
    /// The chip resets: the outputs are off within this many microseconds, then the device is in `Boot`, or in `Fault` with one of
    /// these codes.
    Reset(u64, &'static [Code]),
    /// The device goes on undisturbed.
    GoesOn,
}

/// A fault to inject, with the state it occurs in and the expected result.
#[derive(Debug, Clone, Copy)]
pub struct Injection {
    /// Name of the injection for reports.
    pub name: &'static str,
    /// The state of the device in which the fault happens.
    pub when: When,
    /// Microseconds later than a round time: the moment within the PWM and the control period.
    pub moment_us: u64,
    /// The fault that is injected.
    pub fault: Fault,
    /// The expected result.
    pub expect: Expect,
    /// A second fault, injected while the first is latched; it must change nothing.
    pub then: Option<Fault>,
    /// Once its cause is gone and it was left by `Stop`, the device calibrates and arms as if nothing had been.
    pub again: bool,
}

impl Injection {
    /// Description of the device's state, for reports.
    #[must_use]
    pub fn state(&self) -> String {
        format!("{:?}", self.when).to_lowercase()
    }

    /// Name and state: what `--only` and the list of sabotages ask for.
    #[must_use]
    pub fn title(&self) -> String {
        format!("{}, {}", self.name, self.state())
    }

    const fn again(mut self) -> Self {
        self.again = true;
        self
    }

    const fn then(mut self, fault: Fault) -> Self {
        self.then = Some(fault);
        self
    }
}

const fn row(
    name: &'static str,
    when: When,
    moment_us: u64,
    fault: Fault,
    expect: Expect,
) -> Injection {
    Injection {
        name,
        when,
        moment_us,
        fault,
        expect,
        then: None,
        again: false,
    }
}

/// One control tick at 1 kHz, and the time of a PWM period until the next sample, us.
const TICK: u64 = 1_050;
/// One control tick: the outputs are off from the first bad reading on, and the third is latched as a fault.
const OFF_AT_FIRST_BAD: u64 = TICK;
/// Limit for a seventh of the frames bad, two to four of them in a tick. Each bad reading adds 50, each good one takes
/// 1 away, and 1,000 are too many (`drive/src/supervisor/share.rs`). At two frames in a tick that takes 75 ticks;
/// nearly twice that, us.
const OFF_AT_SHARE: u64 = 150_000;
/// Limit for windings that answer the voltage otherwise than the motor's model, us (`docs/faults/25-motor-model.md`).
const OFF_AT_MODEL: u64 = 50_000;
/// Two control ticks: one requests the AS5047P's field, the next gets the answer.
const OFF_AT_BAD_FIELD: u64 = 2 * TICK;
/// A shaft at 150 rad/s makes 391 counts in a control period, and 265 are too many: a first reading may see 0.68 of a period and
/// not be enough, the one after it is. And the PWM period in which its tick switches off, us.
const FAST_SHAFT: u64 = 1_740;
/// Limit for a lockup, which pulls the break in hardware well before the window watchdog would end it as well. When the
/// stack is full, the next interrupt causes the lockup, at most a PWM period later.
const LOCKUP: u64 = 60;
/// The window watchdog: eleven counts of its clock (`firmware/src/window.rs`), and the time since the last refresh, us.
const WINDOW_WATCHDOG: u64 = 270;
/// The independent watchdog at its slowest, and the longest time without a feeding before it counts (docs/firmware.md).
const WATCHDOG: u64 = 112_000;
