//! The list of fault injections, each with the state of the device, the moment and the expected result.

mod as5047p;
mod asked;
mod beside;
mod esc1;
mod g431rb;
mod ihm16m1;
mod motion;
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
pub use motion::{MODEL, MOTION};
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
    /// The device is stopped. The fault happens, and then a calibration is requested.
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
    /// Whether the motor's outputs are on in this state.
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
    /// Within this many microseconds the outputs are off and stay off; before the end of that time they may switch. One of these
    /// fault codes is latched.
    OffAtLast(u64, &'static [Code]),
    /// The chip resets: the outputs are off within this many microseconds, then the device is in `Boot`, or in `Fault` with one of
    /// these codes.
    Reset(u64, &'static [Code]),
    /// The fault does not disturb the device.
    GoesOn,
}

impl Expect {
    /// The fault code that the device must latch; `None` if several codes are allowed or none is expected.
    #[must_use]
    pub const fn only_code(self) -> Option<Code> {
        match self {
            Self::Off(_, [code]) | Self::OffAtLast(_, [code]) => Some(*code),
            _ => None,
        }
    }
}

/// A fault to inject, with the state it occurs in and the expected result.
#[derive(Debug, Clone, Copy)]
pub struct Injection {
    /// Name of the injection for reports.
    pub name: &'static str,
    /// The state of the device in which the fault happens.
    pub when: When,
    /// Delay of the injection in microseconds after the device has reached its state. It varies the moment within the PWM period
    /// and the control period.
    pub moment_us: u64,
    /// The fault that is injected.
    pub fault: Fault,
    /// The expected result of the injection.
    pub expect: Expect,
    /// A second fault, injected while the first is latched; it must change nothing.
    pub then: Option<Fault>,
    /// Whether to check that the device calibrates and arms as before, once the fault's cause is gone and `Stop` has cleared the
    /// fault.
    pub again: bool,
}

impl Injection {
    /// Name of the device's state in which the fault happens, for reports.
    #[must_use]
    pub fn state(&self) -> String {
        format!("{:?}", self.when).to_lowercase()
    }

    /// Name and state of the injection, the text that `--only` and the list of sabotages select.
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

/// Time limit in µs for a reaction in the next control period at 1 kHz: a control period, and one PWM period until the next current
/// sample.
const TICK: u64 = 1_050;
/// Time limit in µs for bad encoder readings: one control period. The first bad reading switches the outputs off; the third one
/// latches the fault.
const OFF_AT_FIRST_BAD: u64 = TICK;
/// Time limit in µs if a seventh of the encoder's frames are bad, with two to four frames in a control period. Each bad reading
/// adds 50 to a sum, each good one takes 1 away, and 1,000 is a fault (`drive/src/supervisor/share.rs`). With one reading of two
/// frames in a period, the fault comes after some 75 periods; the limit is twice that.
const OFF_AT_SHARE: u64 = 150_000;
/// Time limit in µs for windings whose current does not match the voltage by the motor's model (`docs/faults/25-motor-model.md`).
const OFF_AT_MODEL: u64 = 50_000;
/// Time limit in µs for a shaft that is shaken at 25 Hz, from the first motion on. The fault needs eight reversals of 20 ms each.
/// Half as much is added for the beginning, when the shaft moves one way only.
const OFF_AT_OSCILLATION: u64 = 240_000;
/// Time limit in µs for a shaft that is turned through the wall at 30 rad/s. After some 10 ms the wall's force is a quarter of its
/// largest, and the check takes another 10 ms. The limit is twice the sum.
const OFF_AT_RUNAWAY: u64 = 40_000;
/// Time limit in µs for a wrong field of the AS5047P's magnet, two control periods: one requests the register, the next gets the
/// answer.
const OFF_AT_BAD_FIELD: u64 = 2 * TICK;
/// Time limit in µs for a shaft that turns at 150 rad/s: 391 counts in a control period, where 265 are allowed. The first reading
/// may come less than 0.68 of a period after the fault and find too few counts; the next reading must detect it. A PWM period until
/// the outputs are off is added.
const FAST_SHAFT: u64 = 1_740;
/// Time limit in µs for a processor lockup, which triggers the break in hardware well before the window watchdog would reset. When
/// the stack is full, the next interrupt causes the lockup, at most a PWM period later.
const LOCKUP: u64 = 60;
/// Time limit in µs for a reset by the window watchdog: eleven counts of its clock (`firmware/src/window.rs`), and the time since
/// the last refresh.
const WINDOW_WATCHDOG: u64 = 270;
/// Time limit in µs for a reset by the independent watchdog: its longest time at its slowest clock, and the longest time from the
/// fault until feedings stop (docs/firmware.md).
const WATCHDOG: u64 = 112_000;
