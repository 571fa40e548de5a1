//! Fault injections on the NUCLEO-G431RB with the shield X-NUCLEO-IHM16M1. The board has the same chip as the B-G431B-ESC1.
//!
//! Injections that depend on the shield are in `ihm16m1.rs`. This module has those that depend on the chip and on the board's own
//! program.

use super::Expect::{GoesOn, Off, Reset};
use super::When::{Calibrating, Free, Pressed};
use super::{Injection, TICK, WATCHDOG, row};
use crate::chip::ResetCause;
use crate::fil::fault::{CONTROL_TICK, CURRENT_LOOP, Fault, Level, SERIAL};
use crate::peripheral::spi::SlaveFault;
use touchstone_protocol::FaultCode::*;

/// Number of the interrupt of the serial port, LPUART1.
const LPUART1: u32 = 91;
const TIM3: u32 = 29;

/// Injections on this board in addition to those of the shield.
pub const ON_G431RB: &[Injection] = &[
    row(
        "encoder stuck while the field turns",
        Calibrating,
        222,
        Fault::Encoder(SlaveFault::Stuck),
        Off(8_000_000, &[EncoderStuck]),
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
    // The timer's main output lowers the enables, because the processor in lockup cannot.
    row(
        "supply gone for a moment",
        Pressed,
        707,
        Fault::Reset(ResetCause::BrownOut),
        Reset(TICK, &[BrownOut]),
    ),
    row(
        "20,000 random bytes",
        Pressed,
        48,
        Fault::Noise(20_000, false),
        GoesOn,
    ),
];
