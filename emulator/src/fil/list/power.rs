//! Fault injections into currents, bus voltage and temperature, and into the break signal of the board.

use super::Expect::{GoesOn, Off};
use super::When::{Calibrating, Free, Pressed, Ready};
use super::{Injection, TICK, row};
use crate::fil::fault::Fault;
use touchstone_protocol::FaultCode::*;

/// Injections into currents, bus voltage, temperature and break, on the NUCLEO-G474RE with an AS5047P on the SPI bus.
pub const POWER: &[Injection] = &[
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
];
