//! Injections that concern neither a sensor nor the processor: a person at the button, a brisk flick.

use super::Expect::{GoesOn, Off};
use super::When::{Calibrating, Free, Pressed, Ready};
use super::{Injection, TICK, row};
use crate::fil::fault::Fault;
use touchstone_protocol::FaultCode::*;

/// The injections with the AS5047P on the bus, on the board with a button.
pub const BESIDE: &[Injection] = &[
    row(
        "stop button, 50 ms",
        Pressed,
        345,
        Fault::StopPressed(50_000),
        Off(TICK, &[StopButton]),
    )
    .again(),
    row(
        "stop button, 50 ms",
        Calibrating,
        678,
        Fault::StopPressed(50_000),
        Off(TICK, &[StopButton]),
    ),
    row(
        "stop button, 50 ms",
        Ready,
        12,
        Fault::StopPressed(50_000),
        Off(TICK, &[StopButton]),
    ),
    row(
        // A knob of 40 mm whose rim moves at 1.8 m/s: away from the wall, and let go.
        "flicked at 90 rad/s",
        Free,
        456,
        Fault::Flicked(-90.0, 12_000),
        GoesOn,
    ),
];
