//! Faults of a haptic device, each with advice what to do.

use std::fmt;
use touchstone_sim::error::Error;

/// Why a device switched its own motors off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SwitchOff {
    /// The device's button was pressed or released.
    Button,
    /// The device was moved faster than its own limit.
    Velocity,
    /// The device's watchdog received no command in time.
    Watchdog,
    /// A program on the computer switched the motors off.
    Software,
    /// The USB connection was lost.
    Usb,
    /// The handle was not held (dead-man switch).
    DeadMan,
    /// A cause that this program does not know, with the device's number for it.
    Other(i32),
}

impl fmt::Display for SwitchOff {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Button => "its button",
            Self::Velocity => "its velocity limit",
            Self::Watchdog => "its watchdog",
            Self::Software => "a program",
            Self::Usb => "a lost USB",
            Self::DeadMan => "its dead man's switch",
            Self::Other(number) => return write!(f, "cause {number}"),
        })
    }
}

/// A fault after which no force may act.
#[derive(Debug, Clone, PartialEq)]
pub enum HapticFault {
    /// The device does not answer. Holds the name of the call and the error message.
    Lost(&'static str, String),
    /// The device is in use by another program.
    HeldElsewhere,
    /// The device is present but cannot be used. Holds the reason and the advice.
    Unusable(String, String),
    /// No program answers where the device's service should be. Holds the service's address and the reason.
    NoService(String),
    /// The device switched its motors off without a command.
    SwitchedOff(SwitchOff),
    /// No new position arrived for this time, s.
    Stale(f64),
    /// A position or a force is not a finite number; holds its name.
    NotFinite(&'static str),
    /// The motors gave less force than commanded for this time, s.
    Saturated(f64),
    /// A control interval (tick) began late by this time, s.
    Late(f64),
    /// The position jumped faster than a hand moves. Holds the speed, m/s.
    Jumped(f64),
    /// The device moved faster than the speed up to which the energy guard's bound holds.
    Overspeed,
    /// The position is this far outside the workspace, m.
    Outside(f64),
}

impl fmt::Display for HapticFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Lost(call, said) => write!(f, "{call} failed: {said}"),
            Self::HeldElsewhere => write!(f, "another program holds it"),
            Self::Unusable(why, _) => f.write_str(why),
            Self::NoService(why) => write!(f, "no service at {why}"),
            Self::SwitchedOff(cause) => write!(f, "it switched its motors off: {cause}"),
            Self::Stale(seconds) => {
                write!(f, "it sent no new position for {:.1} ms", seconds * 1e3)
            }
            Self::NotFinite(what) => write!(f, "it reported a {what} that is not a number"),
            Self::Saturated(seconds) => {
                write!(
                    f,
                    "for {seconds:.2} s its motors gave less force than commanded"
                )
            }
            Self::Late(seconds) => write!(f, "a tick came {:.1} ms late", seconds * 1e3),
            Self::Jumped(speed) => write!(f, "its position jumped, {speed:.1} m/s"),
            Self::Overspeed => write!(f, "it moves faster than the energy guard allows"),
            Self::Outside(far) => write!(f, "{:.0} mm outside its workspace", far * 1e3),
        }
    }
}

impl HapticFault {
    /// The advice how to remove the fault.
    #[must_use]
    pub fn fix(&self) -> &str {
        match self {
            Self::Lost(..) => "check its supply and its USB cable, then start again",
            Self::HeldElsewhere => "end the other program",
            Self::Unusable(_, fix) => fix,
            Self::NoService(_) => "start Haply's service, or give its place by --haply HOST:PORT",
            Self::SwitchedOff(_) => {
                "press its force button if it has one; see docs/devices.md#faults"
            }
            Self::Stale(_) | Self::Jumped(_) => {
                "check the cable and the device's calibration, then start again"
            }
            Self::NotFinite(_) => "report it: docs/devices.md#faults",
            Self::Saturated(_) => "lower --force-limit-n",
            Self::Late(_) => {
                "lower --rate-hz, end other programs, or permit real-time priority: docs/devices.md#real-time"
            }
            Self::Overspeed => "move it slower",
            Self::Outside(_) => "bring it back to its centre, then start again",
        }
    }

    /// Converts the fault to the program's error, whose message names the device by `place`.
    #[must_use]
    pub fn at(&self, place: &str) -> Error {
        Error::device(place, self.to_string(), self.fix())
    }
}
