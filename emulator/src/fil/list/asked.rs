//! Fault injections that detect sabotaged firmware (`cargo xtask fil --sabotage`): programs from which a part of a safety function
//! was removed. Without these injections no test would notice that the part is missing.
//!
//! The mildest way to stop a part of the program is to clear its enable bit in the interrupt controller. Then nothing hangs, and a
//! watchdog that any running code refreshes does not act. Another injection is a break during the current loop, which a decision
//! made earlier in the loop must not undo.

use super::Expect::{Off, Reset};
use super::When::{Calibrating, Free, Measuring, Pressed, Starting};
use super::{Injection, TICK, WATCHDOG, WINDOW_WATCHDOG, row};
use crate::fil::fault::{CURRENT_LOOP, Fault, LPTIM1};
use touchstone_protocol::FaultCode::*;

/// Number of the current loop's interrupt, ADC1_2.
const ADC1_2: u32 = 18;
const LPUART1: u32 = 91;
const TIM5: u32 = 50;

/// Time limit in microseconds for the reset after the interrupt of the serial port was lost. The port's task stops when its send
/// buffer of 768 bytes is full: after 32 ms with one telemetry record of at least 24 bytes per ms. The watchdog's time follows.
const LINK: u64 = WATCHDOG + 768 / 24 * 1_000;

/// Injections that detect sabotaged firmware, on a NUCLEO-G474RE with an AS5047P on the SPI bus.
pub const ASKED_FOR: &[Injection] = &[
    row(
        "current loop comes no more",
        Pressed,
        90,
        Fault::Lost(ADC1_2, 0),
        Reset(WINDOW_WATCHDOG, &[Watchdog]),
    ),
    row(
        "control tick comes no more",
        Pressed,
        260,
        Fault::Lost(LPTIM1, 0),
        Reset(2 * TICK + 1_000, &[Watchdog]),
    ),
    row(
        "control tick is left out once",
        Pressed,
        700,
        Fault::Lost(LPTIM1, 1_200),
        Off(2 * TICK, &[DeadlineMiss]),
    ),
    row(
        "control tick stays away for 5 ms",
        Free,
        333,
        Fault::Lost(LPTIM1, 5_000),
        Off(2 * TICK + 1_000, &[StaleCommand]),
    ),
    row(
        "serial port comes no more",
        Free,
        470,
        Fault::Lost(LPUART1, 0),
        Reset(LINK, &[Watchdog]),
    ),
    row(
        "time driver comes no more",
        Pressed,
        580,
        Fault::Lost(TIM5, 0),
        Reset(WATCHDOG, &[Watchdog]),
    ),
    row(
        "break, 1 us long, during the current loop",
        Pressed,
        0,
        Fault::BreakWithin(CURRENT_LOOP, 3),
        Off(TICK, &[HardwareBreak]),
    ),
    row(
        "phase A's sensor is off by 5 A",
        Starting,
        0,
        Fault::Sensor(0, 5.0),
        Off(TICK, &[CurrentSensor]),
    ),
    row(
        "phase B's sensor jumps by 5 A",
        Measuring,
        0,
        Fault::Sensor(1, 5.0),
        Off(TICK, &[CurrentSensor]),
    ),
    row(
        "shaft turned slowly by hand",
        Calibrating,
        130,
        Fault::Turned(3.0),
        Off(8_000_000, &[CalibrationFailed]),
    ),
];
