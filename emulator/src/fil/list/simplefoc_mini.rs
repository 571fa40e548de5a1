//! On the NUCLEO-G474RE with a SimpleFOC Mini: no current is measured and no temperature, the driver's line is all that is known of both.
//! Here also stand the faults that this board does not find.

use super::Expect::{GoesOn, Off, OffAtLast, Reset};
use super::When::{Calibrating, Free, Pressed, Ready};
use super::{
    FAST_SHAFT, Injection, LOCKUP, OFF_AT_FIRST_BAD, OFF_AT_SHARE, TICK, WINDOW_WATCHDOG, row,
};
use crate::chip::ResetCause;
use crate::fil::fault::{CONTROL_TICK, CURRENT_LOOP, Fault};
use crate::peripheral::spi::SlaveFault;
use touchstone_protocol::FaultCode::*;

/// Limit for a driver that switches itself off: its line ends the same PWM period.
const BY_ITSELF: u64 = 60;

/// The injections with nFAULT at PB12 (the break input) and an AS5047P on the bus.
pub const ON_SIMPLEFOC_MINI: &[Injection] = &[
    row(
        "driver's line low, 2 us long",
        Pressed,
        11,
        Fault::Break(2),
        Off(BY_ITSELF, &[GateDriver]),
    )
    .again(),
    row(
        "driver's line low, 300 us long",
        Calibrating,
        444,
        Fault::Break(300),
        Off(BY_ITSELF, &[GateDriver]),
    ),
    row(
        "driver's line stays low",
        Ready,
        333,
        Fault::Break(0),
        Off(TICK, &[GateDriver]),
    ),
    row(
        "driver at 160 degrees C",
        Pressed,
        90,
        Fault::Temperature(160.0),
        Off(BY_ITSELF, &[GateDriver]),
    ),
    // What is not found here: nobody reads a temperature.
    row(
        "driver at 95 degrees C: nobody knows",
        Pressed,
        90,
        Fault::Temperature(95.0),
        GoesOn,
    ),
    row(
        "bus at 20 V",
        Pressed,
        120,
        Fault::Bus(20.0, 0),
        Off(TICK, &[OverVoltage]),
    ),
    row(
        "bus at 8 V",
        Calibrating,
        610,
        Fault::Bus(8.0, 0),
        Off(TICK, &[UnderVoltage]),
    ),
    // Within its limits another supply is no other force: duties follow it.
    row("bus at 15 V", Pressed, 77, Fault::Bus(15.0, 0), GoesOn),
    row(
        "encoder's parity",
        Pressed,
        345,
        Fault::Encoder(SlaveFault::FlipBit(0)),
        Off(OFF_AT_FIRST_BAD, &[EncoderCheck]),
    ),
    row(
        "encoder stuck while the field turns",
        Calibrating,
        222,
        Fault::Encoder(SlaveFault::Stuck),
        Off(8_000_000, &[EncoderStuck]),
    ),
    // Elsewhere the back-EMF in the voltage gives it away; here the voltage is what was asked for. The field stands still then, and holds.
    row(
        "encoder stuck under a press: nobody knows",
        Pressed,
        222,
        Fault::Encoder(SlaveFault::Stuck),
        GoesOn,
    ),
    row(
        "shaft turned at +150 rad/s",
        Free,
        566,
        Fault::Turned(150.0),
        Off(FAST_SHAFT, &[OverSpeed]),
    ),
    row(
        "control tick hangs",
        Pressed,
        52,
        Fault::Hang(CONTROL_TICK),
        Off(2 * TICK, &[Watchdog]),
    ),
    row(
        "current loop hangs",
        Free,
        377,
        Fault::Hang(CURRENT_LOOP),
        Reset(WINDOW_WATCHDOG, &[Watchdog]),
    ),
    // EN falls with the timer's main output: no processor is left that could lower it.
    row(
        "stack overflows",
        Pressed,
        412,
        Fault::StackOverflow,
        Reset(LOCKUP, &[Panic, Watchdog]),
    ),
    row(
        "supply sags to 2.5 V",
        Pressed,
        607,
        Fault::Supply(2.5),
        Off(BY_ITSELF, &[BrownOut]),
    )
    .again(),
    row(
        "reset button",
        Pressed,
        188,
        Fault::Reset(ResetCause::Pin),
        Reset(TICK, &[]),
    ),
    row(
        "encoder's parity in every seventh frame",
        Pressed,
        310,
        Fault::Encoder(SlaveFault::FlipSeventh),
        OffAtLast(OFF_AT_SHARE, &[EncoderUnsteady]),
    ),
];
