//! Injections of a second fault while the first is latched. The outputs must stay off, the reported cause must stay the first one,
//! and only `Stop` clears the fault.

use super::Expect::Off;
use super::When::{Calibrating, Free, Pressed, Ready};
use super::{Injection, OFF_AT_FIRST_BAD, TICK, row};
use crate::fil::fault::Fault;
use crate::peripheral::spi::SlaveFault;
use touchstone_protocol::FaultCode::*;

/// Pairs of faults. The second is injected 30 ms after the first is latched.
pub const SECOND: &[Injection] = &[
    row(
        "phase A reads +8 A, then the break",
        Pressed,
        23,
        Fault::Sensor(0, 8.0),
        Off(TICK, &[OverCurrent]),
    )
    .then(Fault::Break(0)),
    row(
        "break, 5 us long, then a bus at 33 V",
        Free,
        137,
        Fault::Break(5),
        Off(TICK, &[HardwareBreak]),
    )
    .then(Fault::Bus(33.0, 0)),
    row(
        "bus at 33 V, then the supply sags",
        Pressed,
        401,
        Fault::Bus(33.0, 0),
        Off(TICK, &[OverVoltage]),
    )
    .then(Fault::Supply(2.5)),
    row(
        "supply sags, then the break",
        Calibrating,
        59,
        Fault::Supply(2.5),
        Off(TICK, &[BrownOut]),
    )
    .then(Fault::Break(300)),
    row(
        "encoder jumps, then its bus hangs",
        Free,
        666,
        Fault::Encoder(SlaveFault::Jump(0x4000)),
        Off(TICK, &[EncoderJump]),
    )
    .then(Fault::BusHangs),
    row(
        "encoder's parity, then 95 degrees C",
        Pressed,
        202,
        Fault::Encoder(SlaveFault::FlipBit(3)),
        Off(OFF_AT_FIRST_BAD, &[EncoderCheck]),
    )
    .then(Fault::Temperature(95.0)),
    row(
        "bus at 15 V, then phase B reads -8 A",
        Ready,
        515,
        Fault::Bus(15.0, 0),
        Off(TICK, &[UnderVoltage]),
    )
    .then(Fault::Sensor(1, -8.0)),
];
