//! Power stage of the board B-G431B-ESC1.
//!
//! | number | source |
//! |---|---|
//! | shunts, amplifier's network, bus divider | the board's schematic, as NuttX and SimpleFOC quote it; the schematic itself was **not read** |
//! | six lithium cells at most | UM2516, its first page |
//! | 10 V at least | this project's choice: three cells at 3.3 V; where the gate drivers' own supply begins was **not read** |
//! | the amplifier's 13 MHz | the chip's data sheet DS12589, OPAMP |
//! | all numbers taken from `IHM08M1` | the same parts or the same program as with that shield |
//!
//! Pins: `firmware/src/board/b_g431b_esc1.rs`. Nothing was measured on a board.

use super::{Hardware, IHM08M1, sampling_counts};
use crate::thermistor::NTC_10K_3455_OVER_4K7;
use touchstone_control::Si;

/// Power stage of the board B-G431B-ESC1: shunts of 0.003 Ω behind a gain of 64/7 around 2.06 V, bus divider 1:10.39, converter of
/// 3.3 V and 12 bits. The board is for six lithium cells, which have 25.2 V when full.
pub const B_G431B_ESC1: Hardware = Hardware {
    // An amplifier of 13 MHz at a gain of 16.
    sampling_counts: sampling_counts(800, 1_000),
    senses_current: true,
    // 3.3 V / 4,096 / (0.003 Ω · 64/7)
    amps_per_code: Si::lit("-0.029373"),
    // 3.3 V / 4,096 · 10.39
    volts_per_code: Si::lit("0.008371"),
    // 16 · 0.9 V/7, as a fraction of 3.3 V, times 4,096.
    offset_code: 2_553,
    current_max_a: Si::lit("25"),
    // Three cells at 3.3 V. No source states below which voltage the board's own supply of the gate drivers fails.
    bus_min_v: Si::lit("10"),
    bus_max_v: Si::lit("26"),
    // As on the shield: the same clock and PWM, the same type of thermistor, the same tolerances.
    pwm_hz: IHM08M1.pwm_hz,
    core_hz: IHM08M1.core_hz,
    timer_top: IHM08M1.timer_top,
    offset_tolerance: IHM08M1.offset_tolerance,
    offset_spread: IHM08M1.offset_spread,
    temperature_max_c: IHM08M1.temperature_max_c,
    thermistor: NTC_10K_3455_OVER_4K7,
};
