//! Injections that concern neither a sensor nor the processor: a person presses the stop button or turns the knob quickly.

use super::Expect::{GoesOn, Off};
use super::When::{Calibrating, Free, Pressed, Ready};
use super::{Injection, TICK, row};
use crate::fil::fault::Fault;
use touchstone_protocol::FaultCode::*;

/// Injections on boards with a stop button and with an AS5047P on the SPI bus.
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
        // A hand flicks a knob of 40 mm away from the wall, its rim moving at 1.8 m/s, and releases it.
        "flicked at 90 rad/s",
        Free,
        456,
        Fault::Flicked(-90.0, 12_000),
        GoesOn,
    ),
];
