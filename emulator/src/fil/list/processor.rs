//! Fault injections into the processor, its program and its supply: too slow, hanging, endless interrupts, resets, noise on the
//! serial line.

use super::Expect::{GoesOn, Off, Reset};
use super::When::{Calibrating, Free, Pressed};
use super::{Injection, LOCKUP, TICK, WATCHDOG, WINDOW_WATCHDOG, row};
use crate::chip::ResetCause;
use crate::fil::fault::{CONTROL_TICK, CURRENT_LOOP, Fault, Level, SERIAL};
use touchstone_protocol::FaultCode::*;

/// Injections into processor, program and supply, on the NUCLEO-G474RE with an AS5047P on the SPI bus.
pub const PROCESSOR: &[Injection] = &[
    row(
        "processor 25 times slower",
        Free,
        650,
        Fault::Slow(25),
        Reset(TICK, &[DeadlineMiss]),
    ),
    row(
        "processor 10 times slower",
        Pressed,
        150,
        Fault::Slow(10),
        Reset(TICK, &[DeadlineMiss]),
    ),
    row(
        "processor 25 times slower",
        Calibrating,
        420,
        Fault::Slow(25),
        Reset(TICK, &[DeadlineMiss]),
    ),
    row(
        "storm of interrupts, serial port",
        Free,
        10,
        Fault::Storm(91, 60),
        Reset(WATCHDOG, &[Watchdog]),
    ),
    row(
        "storm of interrupts, time driver",
        Pressed,
        730,
        Fault::Storm(50, 60),
        Reset(WATCHDOG, &[Watchdog]),
    ),
    row(
        "thread hangs",
        Pressed,
        5,
        Fault::Hang(Level::Thread),
        Reset(WATCHDOG, &[Watchdog]),
    ),
    row(
        "serial port's handler hangs",
        Free,
        620,
        Fault::Hang(SERIAL),
        Reset(WATCHDOG, &[Watchdog]),
    ),
    row(
        "control tick hangs",
        Pressed,
        50,
        Fault::Hang(CONTROL_TICK),
        // Two ticks, because the control tick may hang only at its end, after it has sent its command.
        Off(2 * TICK, &[Watchdog]),
    ),
    row(
        "control tick hangs",
        Calibrating,
        900,
        Fault::Hang(CONTROL_TICK),
        // Two ticks, because the control tick may hang only at its end, after it has sent its command.
        Off(2 * TICK, &[Watchdog]),
    ),
    row(
        "current loop hangs",
        Free,
        370,
        Fault::Hang(CURRENT_LOOP),
        Reset(WINDOW_WATCHDOG, &[Watchdog]),
    ),
    row(
        "current loop hangs",
        Pressed,
        744,
        Fault::Hang(CURRENT_LOOP),
        Reset(WINDOW_WATCHDOG, &[Watchdog]),
    ),
    row(
        "current loop hangs",
        Calibrating,
        8,
        Fault::Hang(CURRENT_LOOP),
        Reset(WINDOW_WATCHDOG, &[Watchdog]),
    ),
    row(
        "control tick held off for 0.9 ms",
        Pressed,
        300,
        Fault::HeldOff(900),
        Off(TICK, &[DeadlineMiss]),
    ),
    row(
        "control tick held off for 0.9 ms",
        Calibrating,
        800,
        Fault::HeldOff(900),
        Off(TICK, &[DeadlineMiss]),
    ),
    row(
        "undefined instruction, thread",
        Pressed,
        250,
        Fault::Undefined(Level::Thread),
        Reset(TICK, &[Panic]),
    ),
    row(
        "undefined instruction, control tick",
        Free,
        815,
        Fault::Undefined(CONTROL_TICK),
        Reset(TICK, &[Panic]),
    ),
    row(
        "undefined instruction, current loop",
        Calibrating,
        35,
        Fault::Undefined(CURRENT_LOOP),
        Reset(TICK, &[Panic]),
    ),
    row(
        "stack overflows",
        Pressed,
        410,
        Fault::StackOverflow,
        Reset(LOCKUP, &[Panic, Watchdog]),
    ),
    row(
        "supply sags to 2.5 V",
        Pressed,
        605,
        Fault::Supply(2.5),
        Off(TICK, &[BrownOut]),
    )
    .again(),
    row(
        "supply sags to 2.5 V",
        Calibrating,
        95,
        Fault::Supply(2.5),
        Off(TICK, &[BrownOut]),
    )
    .again(),
    row(
        "supply gone for a moment",
        Pressed,
        700,
        Fault::Reset(ResetCause::BrownOut),
        Reset(TICK, &[BrownOut]),
    ),
    row(
        "reset button",
        Pressed,
        180,
        Fault::Reset(ResetCause::Pin),
        Reset(TICK, &[]),
    ),
    row(
        "reboot by command",
        Free,
        280,
        Fault::Reboot,
        Reset(TICK, &[]),
    ),
    row(
        "20,000 random bytes",
        Pressed,
        44,
        Fault::Noise(20_000, false),
        GoesOn,
    ),
    row(
        "4,000 bytes at a wrong baud",
        Pressed,
        66,
        Fault::Noise(4_000, true),
        GoesOn,
    ),
];
