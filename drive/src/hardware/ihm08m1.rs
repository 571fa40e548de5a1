//! Power stage of the shield X-NUCLEO-IHM08M1 on the NUCLEO-G474RE.
//!
//! | number | source |
//! |---|---|
//! | shunts, their pull-up and amplifier, bus divider | the shield's schematic, as NuttX and oxifoc quote it; the schematic itself was **not read** |
//! | supply from 10 to 48 V | UM1996, its first page |
//! | gate drivers turn on at 9 to 10 V, keep 320 ns themselves | L6398's data sheet |
//! | the amplifier's 20 MHz | TSV994's data sheet |
//! | offset's tolerance and spread, largest current, 110 °C | this project's choice: what leaves room for 1 % resistors, an over-current below the sensor's end, the thermistor's table |
//! | clock, PWM, timer | this project's choice: `firmware/src/clock.rs`, `firmware/src/pwm.rs` |
//!
//! Pins: `firmware/src/board/nucleo_g474re.rs`. Nothing was measured on a board.

use super::{Hardware, sampling_counts};
use crate::thermistor::NTC_10K_3455_OVER_4K7;
use touchstone_control::Si;

/// Power stage of the shield X-NUCLEO-IHM08M1 on a NUCLEO-G474RE: shunts of 0.01 Ω, pulled up by 680 Ω and 6.8 kΩ to 3.3 V, behind
/// amplifiers. The total gain is 5.18, with 1.71 V at zero current. Bus divider 169 kΩ over 9.31 kΩ, converter of 3.3 V and 12
/// bits.
pub const IHM08M1: Hardware = Hardware {
    pwm_hz: 20_000,
    core_hz: 170_000_000,
    timer_top: 4_250,
    senses_current: true,
    // An amplifier of 20 MHz at a gain of 5.7.
    sampling_counts: sampling_counts(500, 700),
    // 3.3 V / 4,096 / (0.01 Ω · 5.182)
    amps_per_code: Si::lit("-0.015548"),
    // 3.3 V / 4,096 · 19.153
    volts_per_code: Si::lit("0.015431"),
    offset_code: 2_122,
    offset_tolerance: 250,
    offset_spread: 60,
    current_max_a: Si::lit("15"),
    // The shield is specified from 10 V on (UM1996), and its gate drivers turn on at 9 to 10 V (L6398's data sheet).
    bus_min_v: Si::lit("10"),
    bus_max_v: Si::lit("48"),
    temperature_max_c: Si::lit("110"),
    thermistor: NTC_10K_3455_OVER_4K7,
};
