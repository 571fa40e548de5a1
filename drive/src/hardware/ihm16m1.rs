//! Power stage of the shield X-NUCLEO-IHM16M1, on the NUCLEO-G474RE or the NUCLEO-G431RB.
//!
//! | number | source |
//! |---|---|
//! | shunts of 0.33 Ω, their pull-up of 680 Ω and 2.2 kΩ to 3.3 V, gain 1.53 in all | the shield's schematic, as NuttX and two open benches quote it; the schematic itself was **not read** |
//! | bus divider 1:16 | the same; one of the benches read 12.28 to 12.30 V where a voltmeter read 12.30. NuttX also names resistors that would be 1:19.15: **measure** |
//! | supply from 7 to 45 V | the shield's data, as NuttX quotes it; UM2415 **not read** |
//! | dead time of 550 ns inside the driver | one of the benches; STSPIN830's data sheet **not read** |
//! | the amplifier's 20 MHz, the thermistor at PC4 | taken to be those of X-NUCLEO-IHM08M1: **not read** |
//! | 10 V at least | this project's choice: the range of `limits.bus_min_v`, above what the driver needs |
//! | largest current | this project's choice: 2.5 A of the 3.09 A at which a sensor is at its end; the driver is for 1.5 A rms |
//! | offset's tolerance and spread | as on X-NUCLEO-IHM08M1, in volts and with the same resistors' 1 % |
//! | clock, PWM, timer | this project's choice: `firmware/src/clock.rs`, `firmware/src/pwm.rs` |
//!
//! Pins: `firmware/src/board/nucleo_g474re_ihm16m1.rs`, `nucleo_g431rb_ihm16m1.rs`. Nothing was measured on a board.

use super::{Hardware, IHM08M1, sampling_counts};
use touchstone_control::Si;

/// Power stage of the shield X-NUCLEO-IHM16M1: shunts of 0.33 Ω, pulled up by 680 Ω and 2.2 kΩ to 3.3 V, behind amplifiers with a
/// gain of 2. The total gain is 1.528, with 1.56 V at zero current. Bus divider 1:16, converter of 3.3 V and 12 bits. A code of the
/// converter is 1.6 mA, a tenth of that of the IHM08M1 shield.
pub const IHM16M1: Hardware = Hardware {
    // The first number is the driver's own dead time; the second follows from an amplifier of 20 MHz at a gain of 2.
    sampling_counts: sampling_counts(550, 700),
    senses_current: true,
    // 3.3 V / 4,096 / (0.33 Ω · 1.5278)
    amps_per_code: Si::lit("-0.00159801"),
    // 3.3 V / 4,096 · 16
    volts_per_code: Si::lit("0.012891"),
    // 680/2,880 · 2 of the reference of 3.3 V, times 4,096.
    offset_code: 1_934,
    offset_tolerance: IHM08M1.offset_tolerance,
    offset_spread: IHM08M1.offset_spread,
    current_max_a: Si::lit("2.5"),
    bus_min_v: Si::lit("10"),
    bus_max_v: Si::lit("45"),
    pwm_hz: IHM08M1.pwm_hz,
    core_hz: IHM08M1.core_hz,
    timer_top: IHM08M1.timer_top,
    temperature_max_c: IHM08M1.temperature_max_c,
    thermistor: IHM08M1.thermistor,
};
