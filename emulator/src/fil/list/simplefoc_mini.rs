//! Fault injections on the NUCLEO-G474RE with a SimpleFOC Mini. That board measures neither current nor temperature, so the
//! driver's fault line is the only information about both. Some injections are faults that the board cannot detect.

use super::Expect::{GoesOn, Off, OffAtLast, Reset};
use super::When::{Calibrating, Free, Pressed, Ready};
use super::{Injection, LOCKUP, OFF_AT_FIRST_BAD, OFF_AT_SHARE, TICK, WINDOW_WATCHDOG, row};
use crate::chip::ResetCause;
use crate::fil::fault::{CONTROL_TICK, CURRENT_LOOP, Fault};
use crate::peripheral::spi::SlaveFault;
use touchstone_protocol::FaultCode::*;

/// Time limit in microseconds for a fault at which the driver switches itself off. Its fault line acts in the same PWM period.
const BY_ITSELF: u64 = 60;

/// Injections with nFAULT at PB12 (the break input) and an AS5047P on the SPI bus.
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
    // Not detected on this board: it measures no temperature.
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
    // A supply voltage within its limits does not change the force, because the duty cycles follow the voltage.
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
    // Boards that measure currents detect the stuck encoder by the back-EMF in the voltage. This board commands the voltage
    // itself, so nothing shows the fault. The motor's field then stands still and holds the shaft.
    row(
        "encoder stuck under a press: nobody knows",
        Pressed,
        222,
        Fault::Encoder(SlaveFault::Stuck),
        GoesOn,
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
    // The timer's main output lowers EN, because the processor in lockup cannot.
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
