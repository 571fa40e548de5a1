//! The injections: what, in which state, at which moment, and what must become of it.

use touchstone_protocol::FaultCode as Code;
use touchstone_protocol::FaultCode::*;

use super::fault::{CONTROL_TICK, CURRENT_LOOP, Fault, Level, SERIAL};
use crate::chip::ResetCause;
use crate::peripheral::spi::SlaveFault;

/// In which state it happens.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum When {
    /// Calibrated, outputs off.
    Ready,
    /// The field turns the shaft.
    Calibrating,
    /// Armed, outside of the wall.
    Free,
    /// Armed, a hand presses into the wall.
    Pressed,
}

/// What must become of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Expect {
    /// Outputs off within this many microseconds; one of these codes is latched.
    Off(u64, &'static [Code]),
    /// A reset: outputs off within this many microseconds, then `Boot`, or `Fault` with one of these codes.
    Reset(u64, &'static [Code]),
    /// Nothing: it goes on.
    GoesOn,
}

/// An injection.
#[derive(Debug, Clone, Copy)]
pub struct Injection {
    /// For people.
    pub name: &'static str,
    /// In which state.
    pub when: When,
    /// Microseconds later than a round time: the moment within the PWM and the control period.
    pub moment_us: u64,
    /// What.
    pub fault: Fault,
    /// What must become of it.
    pub expect: Expect,
}

const fn row(
    name: &'static str,
    when: When,
    moment_us: u64,
    fault: Fault,
    expect: Expect,
) -> Injection {
    Injection {
        name,
        when,
        moment_us,
        fault,
        expect,
    }
}

/// One control tick at 1 kHz, and the time of a PWM period until the next sample, us.
const TICK: u64 = 1_050;
/// One control tick: the outputs are off from the first bad reading on, and the third is latched as a fault.
const OFF_AT_FIRST_BAD: u64 = TICK;
/// The independent watchdog at its slowest, and the longest time without a feeding before it counts (docs/firmware.md).
const WATCHDOG: u64 = 112_000;

use Expect::{GoesOn, Off, Reset};
use When::{Calibrating, Free, Pressed, Ready};

/// With the AS5047P on the bus.
pub const WITH_AS5047P: &[Injection] = &[
    row(
        "phase A reads +8 A",
        Pressed,
        3,
        Fault::Sensor(0, 8.0),
        Off(TICK, &[OverCurrent]),
    ),
    row(
        "phase A reads -8 A",
        Pressed,
        17,
        Fault::Sensor(0, -8.0),
        Off(TICK, &[OverCurrent]),
    ),
    row(
        "phase B reads +8 A",
        Free,
        29,
        Fault::Sensor(1, 8.0),
        Off(TICK, &[OverCurrent]),
    ),
    row(
        "phase B reads -8 A",
        Calibrating,
        41,
        Fault::Sensor(1, -8.0),
        Off(TICK, &[OverCurrent]),
    ),
    row(
        "phase A's sensor at its end",
        Free,
        733,
        Fault::Sensor(0, 40.0),
        Off(TICK, &[OverCurrent, CurrentSensor]),
    ),
    row(
        "break, 2 us long",
        Pressed,
        11,
        Fault::Break(2),
        Off(TICK, &[HardwareBreak]),
    ),
    row(
        "break, 300 us long",
        Calibrating,
        444,
        Fault::Break(300),
        Off(TICK, &[HardwareBreak]),
    ),
    row(
        "break that stays",
        Free,
        951,
        Fault::Break(0),
        Off(TICK, &[HardwareBreak]),
    ),
    row(
        "break that stays",
        Ready,
        333,
        Fault::Break(0),
        Off(TICK, &[HardwareBreak]),
    ),
    row(
        "bus at 33 V",
        Pressed,
        120,
        Fault::Bus(33.0, 0),
        Off(TICK, &[OverVoltage]),
    ),
    row(
        "bus at 33 V",
        Calibrating,
        610,
        Fault::Bus(33.0, 0),
        Off(TICK, &[OverVoltage]),
    ),
    row(
        "bus at 33 V for 3 ms",
        Free,
        870,
        Fault::Bus(33.0, 3_000),
        Off(TICK, &[OverVoltage]),
    ),
    row(
        "bus at 33 V",
        Ready,
        55,
        Fault::Bus(33.0, 0),
        Off(TICK, &[OverVoltage]),
    ),
    row(
        "bus at 15 V",
        Pressed,
        260,
        Fault::Bus(15.0, 0),
        Off(TICK, &[UnderVoltage]),
    ),
    row(
        "bus at 15 V for 3 ms",
        Free,
        505,
        Fault::Bus(15.0, 3_000),
        Off(TICK, &[UnderVoltage]),
    ),
    row(
        "bus gone",
        Calibrating,
        777,
        Fault::Bus(0.0, 0),
        Off(TICK, &[UnderVoltage]),
    ),
    row(
        "bus at 15 V",
        Ready,
        940,
        Fault::Bus(15.0, 0),
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
        "95 degrees C",
        Calibrating,
        680,
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
        "thermistor shorted",
        Free,
        390,
        Fault::Thermistor(3.3),
        Off(TICK, &[OverTemperature]),
    ),
    row(
        "thermistor broken off",
        Free,
        205,
        Fault::Thermistor(0.0),
        Off(TICK, &[OverTemperature]),
    ),
    row(
        "encoder's line low",
        Pressed,
        15,
        Fault::Encoder(SlaveFault::Low),
        Off(TICK, &[EncoderStuck, EncoderJump, EncoderSilent, OverSpeed]),
    ),
    row(
        "encoder's line high",
        Pressed,
        350,
        Fault::Encoder(SlaveFault::High),
        Off(OFF_AT_FIRST_BAD, &[EncoderStatus]),
    ),
    row(
        "encoder's line high",
        Calibrating,
        888,
        Fault::Encoder(SlaveFault::High),
        Off(OFF_AT_FIRST_BAD, &[EncoderStatus]),
    ),
    row(
        "encoder's parity, bit 0",
        Free,
        21,
        Fault::Encoder(SlaveFault::FlipBit(0)),
        Off(OFF_AT_FIRST_BAD, &[EncoderCheck]),
    ),
    row(
        "encoder's parity, bit 13",
        Pressed,
        512,
        Fault::Encoder(SlaveFault::FlipBit(13)),
        Off(OFF_AT_FIRST_BAD, &[EncoderCheck]),
    ),
    row(
        "encoder's parity, bit 15",
        Calibrating,
        77,
        Fault::Encoder(SlaveFault::FlipBit(15)),
        Off(OFF_AT_FIRST_BAD, &[EncoderCheck]),
    ),
    row(
        "encoder says it has an error",
        Free,
        640,
        Fault::Encoder(SlaveFault::SaysError),
        Off(OFF_AT_FIRST_BAD, &[EncoderStatus]),
    ),
    row(
        "encoder's bus hangs",
        Pressed,
        999,
        Fault::BusHangs,
        Off(OFF_AT_FIRST_BAD, &[EncoderSilent]),
    ),
    row(
        "encoder's bus hangs",
        Calibrating,
        1,
        Fault::BusHangs,
        Off(OFF_AT_FIRST_BAD, &[EncoderSilent]),
    ),
    row(
        "encoder jumps a quarter turn",
        Pressed,
        480,
        Fault::Encoder(SlaveFault::Jump(0x4000)),
        Off(TICK, &[EncoderJump]),
    ),
    row(
        "encoder jumps half a turn",
        Free,
        20,
        Fault::Encoder(SlaveFault::Jump(0x8000)),
        Off(TICK, &[EncoderJump]),
    ),
    row(
        "encoder jumps 14 degrees",
        Ready,
        130,
        Fault::Encoder(SlaveFault::Jump(0x0a00)),
        Off(TICK, &[EncoderJump, OverSpeed]),
    ),
    row(
        "encoder stuck",
        Calibrating,
        240,
        Fault::Encoder(SlaveFault::Stuck),
        Off(8_000_000, &[EncoderStuck, CalibrationFailed]),
    ),
    row(
        "shaft turned at +90 rad/s",
        Free,
        560,
        Fault::Turned(90.0),
        Off(20_000, &[OverSpeed]),
    ),
    row(
        "shaft turned at -90 rad/s",
        Pressed,
        70,
        Fault::Turned(-90.0),
        Off(20_000, &[OverSpeed]),
    ),
    row(
        "shaft turned at +90 rad/s",
        Ready,
        810,
        Fault::Turned(90.0),
        Off(20_000, &[OverSpeed]),
    ),
    row(
        "shaft held fast",
        Calibrating,
        300,
        Fault::Turned(0.0),
        Off(8_000_000, &[EncoderStuck, CalibrationFailed]),
    ),
    row(
        "processor 25 times slower",
        Free,
        650,
        Fault::Slow(25),
        Reset(WATCHDOG, &[DeadlineMiss, StaleCommand, Watchdog]),
    ),
    row(
        "processor 10 times slower",
        Pressed,
        150,
        Fault::Slow(10),
        Reset(WATCHDOG, &[DeadlineMiss, StaleCommand, Watchdog]),
    ),
    row(
        "processor 25 times slower",
        Calibrating,
        420,
        Fault::Slow(25),
        Reset(WATCHDOG, &[DeadlineMiss, StaleCommand, Watchdog]),
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
        Off(2 * TICK + 1_000, &[Watchdog]),
    ),
    row(
        "control tick hangs",
        Calibrating,
        900,
        Fault::Hang(CONTROL_TICK),
        Off(2 * TICK + 1_000, &[Watchdog]),
    ),
    row(
        "current loop hangs",
        Free,
        370,
        Fault::Hang(CURRENT_LOOP),
        Reset(WATCHDOG, &[Watchdog]),
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
        Reset(2 * TICK, &[Panic]),
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
        Reset(TICK, &[Panic, Watchdog]),
    ),
    row(
        "supply sags to 2.5 V",
        Pressed,
        605,
        Fault::Supply(2.5),
        Off(TICK, &[BrownOut]),
    ),
    row(
        "supply sags to 2.5 V",
        Calibrating,
        95,
        Fault::Supply(2.5),
        Off(TICK, &[BrownOut]),
    ),
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
        Reset(5_000, &[]),
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

/// With an MT6701 on the bus.
pub const WITH_MT6701: &[Injection] = &[
    row(
        "encoder's check sum, bit 0",
        Free,
        12,
        Fault::Encoder(SlaveFault::FlipBit(0)),
        Off(OFF_AT_FIRST_BAD, &[EncoderCheck]),
    ),
    row(
        "encoder's check sum, bit 15",
        Pressed,
        345,
        Fault::Encoder(SlaveFault::FlipBit(15)),
        Off(OFF_AT_FIRST_BAD, &[EncoderCheck]),
    ),
    row(
        "encoder's check sum, bit 23",
        Calibrating,
        678,
        Fault::Encoder(SlaveFault::FlipBit(23)),
        Off(OFF_AT_FIRST_BAD, &[EncoderCheck]),
    ),
    row(
        "encoder's line high",
        Free,
        910,
        Fault::Encoder(SlaveFault::High),
        Off(OFF_AT_FIRST_BAD, &[EncoderCheck, EncoderStatus]),
    ),
    row(
        "encoder loses its track",
        Pressed,
        150,
        Fault::Encoder(SlaveFault::SaysError),
        Off(OFF_AT_FIRST_BAD, &[EncoderStatus]),
    ),
    row(
        "encoder's bus hangs",
        Free,
        520,
        Fault::BusHangs,
        Off(OFF_AT_FIRST_BAD, &[EncoderSilent]),
    ),
    row(
        "encoder jumps a quarter turn",
        Pressed,
        33,
        Fault::Encoder(SlaveFault::Jump(0x4000)),
        Off(TICK, &[EncoderJump]),
    ),
];

/// With an incremental encoder at the timer.
pub const WITH_TRACKS: &[Injection] = &[
    row(
        "encoder held",
        Calibrating,
        200,
        Fault::TrackHeld,
        Off(8_000_000, &[EncoderStuck, CalibrationFailed]),
    ),
    row(
        "encoder jumps a quarter turn",
        Pressed,
        460,
        Fault::TrackJumps(4_096),
        Off(TICK, &[EncoderJump]),
    ),
    row(
        "encoder jumps back by 700",
        Free,
        860,
        Fault::TrackJumps(-700),
        Off(TICK, &[EncoderJump, OverSpeed]),
    ),
];
