//! Fault injections on the B-G431B-ESC1. The board measures currents through the chip's amplifiers, its break comes from the chip's
//! comparators, and its encoder is incremental.

use super::Expect::{GoesOn, Off, Reset};
use super::When::{Calibrating, Free, Pressed, Ready, Starting};
use super::{Injection, TICK, WATCHDOG, WINDOW_WATCHDOG, row};
use crate::chip::ResetCause;
use crate::fil::fault::{CONTROL_TICK, CURRENT_LOOP, Fault, Level, SERIAL_ESC1};
use touchstone_protocol::FaultCode::*;

/// Number of the interrupt of the serial port, USART2.
const USART2: u32 = 38;
const TIM3: u32 = 29;

/// Injections with the board's incremental encoder.
pub const ON_ESC1: &[Injection] = &[
    row(
        "phase A reads +8 A",
        Pressed,
        7,
        Fault::Sensor(0, 8.0),
        Off(TICK, &[OverCurrent]),
    ),
    row(
        "phase B reads -8 A",
        Calibrating,
        31,
        Fault::Sensor(1, -8.0),
        Off(TICK, &[OverCurrent]),
    ),
    row(
        "phase B's sensor at its end",
        Free,
        620,
        Fault::Sensor(1, -60.0),
        Off(TICK, &[OverCurrent]),
    ),
    row(
        "phase B's sensor is off by 10 A",
        Starting,
        0,
        Fault::Sensor(1, 10.0),
        Off(TICK, &[CurrentSensor]),
    ),
    row(
        "comparator of phase A, 2 us long",
        Pressed,
        12,
        Fault::Comparator(1, 2),
        Off(TICK, &[HardwareBreak]),
    ),
    row(
        "comparator of phase A, 1 us long: less than the break's filter",
        Pressed,
        12,
        Fault::Comparator(1, 1),
        GoesOn,
    ),
    row(
        "comparator of phase B, 300 us long",
        Calibrating,
        444,
        Fault::Comparator(2, 300),
        Off(TICK, &[HardwareBreak]),
    ),
    row(
        "comparator of phase C stays",
        Free,
        905,
        Fault::Comparator(4, 0),
        Off(TICK, &[HardwareBreak]),
    ),
    row(
        "bus at 33 V",
        Pressed,
        122,
        Fault::Bus(33.0, 0),
        Off(TICK, &[OverVoltage]),
    ),
    row(
        "bus gone",
        Calibrating,
        771,
        Fault::Bus(0.0, 0),
        Off(TICK, &[UnderVoltage]),
    ),
    row(
        "bus at 33 V",
        Ready,
        56,
        Fault::Bus(33.0, 0),
        Off(TICK, &[OverVoltage]),
    ),
    row(
        "95 degrees C",
        Pressed,
        97,
        Fault::Temperature(95.0),
        Off(TICK, &[OverTemperature]),
    ),
    row(
        "80 degrees C: derated",
        Pressed,
        95,
        Fault::Temperature(80.0),
        GoesOn,
    ),
    row(
        "thermistor broken off",
        Free,
        215,
        Fault::Thermistor(0.0),
        Off(TICK, &[OverTemperature]),
    ),
    row(
        "encoder held",
        Calibrating,
        210,
        Fault::TrackHeld,
        Off(8_000_000, &[EncoderStuck]),
    ),
    row(
        "encoder jumps a quarter turn",
        Pressed,
        462,
        Fault::TrackJumps(4_096),
        Off(TICK, &[EncoderJump]),
    ),
    row(
        "encoder jumps half a turn back",
        Free,
        869,
        Fault::TrackJumps(-8_192),
        Off(TICK, &[EncoderJump]),
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
        Fault::Storm(USART2, 60),
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
        Fault::Hang(SERIAL_ESC1),
        Reset(WATCHDOG, &[Watchdog]),
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
    row(
        "stack overflows",
        Pressed,
        412,
        Fault::StackOverflow,
        Reset(TICK, &[Panic, Watchdog]),
    ),
    row(
        "supply sags to 2.5 V",
        Pressed,
        607,
        Fault::Supply(2.5),
        Off(TICK, &[BrownOut]),
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
    row(
        "comparator of phase A, then a bus at 33 V",
        Pressed,
        71,
        Fault::Comparator(1, 4),
        Off(TICK, &[HardwareBreak]),
    )
    .then(Fault::Bus(33.0, 0)),
];
