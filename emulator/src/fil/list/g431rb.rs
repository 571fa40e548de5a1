//! On the NUCLEO-G431RB with the X-NUCLEO-IHM16M1: the other NUCLEO's shield with the B-G431B-ESC1's chip. What the shield brings about is
//! played here in a sample, as its full list is with the other NUCLEO; what hangs on the chip, and on a program of its own, is here.

use super::Expect::{GoesOn, Off, Reset};
use super::When::{Calibrating, Free, Measuring, Pressed, Ready, Starting};
use super::{
    FAST_SHAFT, Injection, LOCKUP, OFF_AT_FIRST_BAD, TICK, WATCHDOG, WINDOW_WATCHDOG, row,
};
use crate::chip::ResetCause;
use crate::fil::fault::{CONTROL_TICK, CURRENT_LOOP, Fault, Level, SERIAL};
use crate::peripheral::spi::SlaveFault;
use touchstone_protocol::FaultCode::*;

/// The serial port's interrupt, and the time driver's.
const LPUART1: u32 = 91;
const TIM3: u32 = 29;

/// A driver that switches itself off needs nobody; what the line brings about is the same PWM period.
const BY_ITSELF: u64 = 60;

/// With EN\FAULT at PB12, the break, and an AS5047P on the bus.
pub const ON_G431RB: &[Injection] = &[
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
        "encoder stuck while the field turns",
        Calibrating,
        222,
        Fault::Encoder(SlaveFault::Stuck),
        Off(8_000_000, &[EncoderStuck]),
    ),
    row(
        "shaft turned at +150 rad/s",
        Free,
        566,
        Fault::Turned(150.0),
        Off(FAST_SHAFT, &[OverSpeed]),
    ),
    row(
        "stop button, 50 ms",
        Pressed,
        250,
        Fault::StopPressed(50_000),
        Off(TICK, &[StopButton]),
    ),
    row(
        "processor 25 times slower",
        Free,
        655,
        Fault::Slow(25),
        Reset(TICK, &[DeadlineMiss]),
    ),
    row(
        "storm of interrupts, serial port",
        Free,
        15,
        Fault::Storm(LPUART1, 60),
        Reset(WATCHDOG, &[Watchdog]),
    ),
    row(
        "storm of interrupts, time driver",
        Pressed,
        735,
        Fault::Storm(TIM3, 60),
        Reset(WATCHDOG, &[Watchdog]),
    ),
    row(
        "thread hangs",
        Pressed,
        8,
        Fault::Hang(Level::Thread),
        Reset(WATCHDOG, &[Watchdog]),
    ),
    row(
        "serial port's handler hangs",
        Free,
        625,
        Fault::Hang(SERIAL),
        Reset(WATCHDOG, &[Watchdog]),
    ),
    row(
        "control tick hangs",
        Pressed,
        52,
        Fault::Hang(CONTROL_TICK),
        // Two ticks where it hangs at its end, after its command was sent.
        Off(2 * TICK, &[Watchdog]),
    ),
    row(
        "current loop hangs",
        Free,
        377,
        Fault::Hang(CURRENT_LOOP),
        Reset(WINDOW_WATCHDOG, &[Watchdog]),
    ),
    row(
        "undefined instruction, control tick",
        Free,
        816,
        Fault::Undefined(CONTROL_TICK),
        Reset(TICK, &[Panic]),
    ),
    row(
        "undefined instruction, current loop",
        Calibrating,
        36,
        Fault::Undefined(CURRENT_LOOP),
        Reset(TICK, &[Panic]),
    ),
    // The enables fall with the timer's main output: no processor is left that could lower them.
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
        "supply gone for a moment",
        Pressed,
        707,
        Fault::Reset(ResetCause::BrownOut),
        Reset(TICK, &[BrownOut]),
    ),
    row(
        "reset button",
        Pressed,
        188,
        Fault::Reset(ResetCause::Pin),
        Reset(TICK, &[]),
    ),
    row(
        "20,000 random bytes",
        Pressed,
        48,
        Fault::Noise(20_000, false),
        GoesOn,
    ),
];
