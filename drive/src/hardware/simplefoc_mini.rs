//! Power stage of the board SimpleFOC Mini (DRV8313), on the NUCLEO-G474RE. **It measures no current**: neither shunts nor
//! amplifiers are on it.
//!
//! | number | source |
//! |---|---|
//! | no current sensors; one EN for the three channels; nFT, nSP, nRT with 10 kΩ to the driver's 3.3 V | the board's schematic v1.1 (2024-04-26), in its makers' repository |
//! | supply from 8 to 24 V, 2.5 A a phase | the README beside it. The board itself says 8 to 35 V |
//! | VM from 8 to 60 V, inputs up to 250 kHz, pulled down by 100 kΩ | DRV8313's data sheet SLVSBA5D, its tables of operating conditions and inputs |
//! | 0.24 Ω a transistor, over-current at 3 to 5 A and latched, dead time of 90 ns | the same data sheet's other pages, from memory: **not read** |
//! | bus divider of 100 kΩ over 10 kΩ | this project's choice: the board has none, so two resistors belong to the wiring (docs/build-guide.md) |
//! | no temperature | none on the board; the driver switches off by itself, and reports this by its fault line nFT |
//! | 10 V at least | this project's choice: the range of `limits.bus_min_v`, above what the driver needs |
//! | largest current, which the board calculates and does not measure | this project's choice: what the README allows |
//! | clock, PWM, timer | this project's choice: `firmware/src/clock.rs`, `firmware/src/pwm.rs` |
//!
//! Pins: `firmware/src/board/nucleo_g474re_simplefoc_mini.rs`. Nothing was measured on a board.

use super::{Hardware, IHM08M1};
use crate::thermistor::Thermistor;
use touchstone_control::Si;

/// Power stage of the board SimpleFOC Mini: no sensors of current or temperature, bus divider 1:11, converter of 3.3 V and 12 bits.
pub const SIMPLEFOC_MINI: Hardware = Hardware {
    // Without shunts the low side need not be on. All compare values are allowed except the one at which a phase never switches.
    sampling_counts: 2,
    senses_current: false,
    amps_per_code: Si::ZERO,
    offset_code: 0,
    offset_tolerance: 0,
    offset_spread: 0,
    // 3.3 V / 4,096 · 11
    volts_per_code: Si::lit("0.008862"),
    current_max_a: Si::lit("2.5"),
    bus_min_v: Si::lit("10"),
    bus_max_v: Si::lit("24"),
    // This value only limits the range of settings that have no effect on this board.
    temperature_max_c: IHM08M1.temperature_max_c,
    thermistor: Thermistor::NONE,
    pwm_hz: IHM08M1.pwm_hz,
    core_hz: IHM08M1.core_hz,
    timer_top: IHM08M1.timer_top,
};
