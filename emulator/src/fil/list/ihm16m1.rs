//! Fault injections on the shield X-NUCLEO-IHM16M1. Its driver has enable inputs instead of lower inputs, and its own fault line;
//! the currents are small and the supply is 12 V.

use super::Expect::{GoesOn, Off, OffAtLast, Reset};
use super::When::{Calibrating, Free, Measuring, Pressed, Ready, Starting};
use super::{Injection, LOCKUP, OFF_AT_FIRST_BAD, OFF_AT_SHARE, TICK, WINDOW_WATCHDOG, row};
use crate::chip::ResetCause;
use crate::fil::fault::{CONTROL_TICK, CURRENT_LOOP, Fault};
use crate::peripheral::spi::SlaveFault;
use touchstone_protocol::FaultCode::*;

/// Time limit in microseconds for a fault at which the driver switches itself off. Its fault line acts in the same PWM period.
const BY_ITSELF: u64 = 60;

/// Injections on the shield with either NUCLEO, an AS5047P on the SPI bus, and the line EN\FAULT at PB12, the break input.
pub const ON_IHM16M1: &[Injection] = &[
    row(
        "driver's line low, 2 us long",
        Pressed,
        11,
        Fault::Break(2),
        Off(BY_ITSELF, &[GateDriver]),
    )
    .again(),
    row(
        "driver's line stays low",
        Ready,
        333,
        Fault::Break(0),
        Off(TICK, &[GateDriver]),
    ),
    row(
        "driver's line low, 1 us, during the current loop",
        Pressed,
        0,
        Fault::BreakWithin(CURRENT_LOOP, 3),
        Off(BY_ITSELF, &[GateDriver]),
    ),
    row(
        "phase A reads +2.5 A",
        Pressed,
        3,
        Fault::Sensor(0, 2.5),
        Off(TICK, &[OverCurrent]),
    ),
    row(
        "phase B reads -2.5 A",
        Calibrating,
        41,
        Fault::Sensor(1, -2.5),
        Off(TICK, &[OverCurrent]),
    ),
    row(
        "phase A's sensor is off by 0.6 A",
        Starting,
        0,
        Fault::Sensor(0, 0.6),
        Off(TICK, &[CurrentSensor]),
    ),
    row(
        "phase B's sensor jumps by 0.6 A",
        Measuring,
        0,
        Fault::Sensor(1, 0.6),
        Off(TICK, &[CurrentSensor]),
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
    row(
        "95 degrees C",
        Pressed,
        90,
        Fault::Temperature(95.0),
        Off(TICK, &[OverTemperature]),
    ),
    row(
        "80 degrees C: derated",
        Pressed,
        90,
        Fault::Temperature(80.0),
        GoesOn,
    ),
    row(
        "encoder's parity",
        Pressed,
        345,
        Fault::Encoder(SlaveFault::FlipBit(0)),
        Off(OFF_AT_FIRST_BAD, &[EncoderCheck]),
    ),
    row(
        "encoder's bus hangs",
        Free,
        520,
        Fault::BusHangs,
        Off(OFF_AT_FIRST_BAD, &[EncoderSilent]),
    ),
    row(
        "control tick hangs",
        Pressed,
        52,
        Fault::Hang(CONTROL_TICK),
        // Two ticks, because the control tick may hang only at its end, after it has sent its command.
        Off(2 * TICK, &[Watchdog]),
    ),
    row(
        "current loop hangs",
        Free,
        377,
        Fault::Hang(CURRENT_LOOP),
        Reset(WINDOW_WATCHDOG, &[Watchdog]),
    ),
    // The timer's main output lowers the enables, because the processor in lockup cannot.
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

/// Further injections on the shield, which run with the NUCLEO-G474RE only.
pub const MORE_ON_IHM16M1: &[Injection] = &[
    row(
        "driver's line low, 300 us long",
        Calibrating,
        444,
        Fault::Break(300),
        Off(BY_ITSELF, &[GateDriver]),
    ),
    row(
        "driver's line stays low",
        Free,
        951,
        Fault::Break(0),
        Off(BY_ITSELF, &[GateDriver]),
    ),
    row(
        "phase A's sensor at its end",
        Free,
        733,
        Fault::Sensor(0, 8.0),
        Off(TICK, &[OverCurrent, CurrentSensor]),
    ),
    row(
        "thermistor broken off",
        Free,
        205,
        Fault::Thermistor(0.0),
        Off(TICK, &[OverTemperature]),
    ),
];

/// Injections on the shield with an MT6701 on the SPI bus and the line EN\FAULT at PA11, which the current loop reads.
pub const WITH_LINK_R35: &[Injection] = &[
    row(
        "driver's line low, 300 us long",
        Pressed,
        11,
        Fault::Break(300),
        Off(BY_ITSELF, &[GateDriver]),
    )
    .again(),
    row(
        "driver's line stays low",
        Calibrating,
        951,
        Fault::Break(0),
        Off(BY_ITSELF, &[GateDriver]),
    ),
    row(
        "driver's line stays low",
        Ready,
        333,
        Fault::Break(0),
        Off(TICK, &[GateDriver]),
    ),
];
