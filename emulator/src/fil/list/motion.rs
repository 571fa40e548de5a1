//! Fault injections that every board must detect in the same way: wrong motion of the shaft, and a motor that does not fit its
//! model.

use super::Expect::Off;
use super::When::{Free, Pressed};
use super::{FAST_SHAFT, Injection, OFF_AT_MODEL, OFF_AT_OSCILLATION, OFF_AT_RUNAWAY, row};
use crate::fil::fault::Fault;
use touchstone_protocol::FaultCode::*;

/// Injections on every board.
pub const MOTION: &[Injection] = &[
    row(
        "shaft shaken at 25 Hz",
        Pressed,
        410,
        Fault::Shaken(14.0, 20_000),
        Off(OFF_AT_OSCILLATION, &[Oscillation]),
    ),
    row(
        "shaft turned through the wall at 30 rad/s",
        Pressed,
        455,
        Fault::Turned(30.0),
        Off(OFF_AT_RUNAWAY, &[Runaway]),
    ),
    row(
        "shaft turned at +150 rad/s",
        Free,
        566,
        Fault::Turned(150.0),
        Off(FAST_SHAFT, &[OverSpeed]),
    ),
];

/// Injections on every board that measures its currents.
pub const MODEL: &[Injection] = &[row(
    "phase A's sensor stays at rest",
    Pressed,
    210,
    Fault::Sensor(0, 0.0),
    Off(OFF_AT_MODEL, &[MotorModel]),
)];
