//! What a board's parts make of volts and amperes: constants, no pins.

use crate::modulation::Modulator;
use crate::thermistor::{NTC_10K_3455_OVER_4K7, Thermistor};
use crate::units::clamp_i32;
use touchstone_control::Si;

/// A board's power stage as the converter sees it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hardware {
    /// PWM rate and rate of the current loop, Hz.
    pub pwm_hz: u32,
    /// Processor clock, Hz: the unit of [`crate::timing`].
    pub core_hz: u32,
    /// Compare value at which a phase is always high (centre-aligned: `core_hz / (2 pwm_hz)`).
    pub timer_top: u16,
    /// Timer counts that the low side must be on for so that its shunt can be sampled: settling, dead time, conversion.
    pub sampling_counts: u16,
    /// A of current into the motor per code of the converter. Negative with shunts below the lower transistors and amplifiers that do
    /// not invert: that current comes from ground, and pulls the shunt's upper end below it.
    pub amps_per_code: Si,
    /// V of bus voltage per code.
    pub volts_per_code: Si,
    /// Code that the current sensors show without current, by their schematic.
    pub offset_code: u16,
    /// How far a measured offset may be from it, codes.
    pub offset_tolerance: u16,
    /// How far apart readings without current may be, codes.
    pub offset_spread: u16,
    /// Largest current that the sensors resolve with a reserve, A.
    pub current_max_a: Si,
    /// Lowest bus voltage at which the gate drivers work, V.
    pub bus_min_v: Si,
    /// Highest bus voltage, V.
    pub bus_max_v: Si,
    /// Highest temperature of the power stage, degrees Celsius.
    pub temperature_max_c: Si,
    /// The temperature sensor.
    pub thermistor: Thermistor,
}

/// Timer counts, at 170 MHz, for which the low side must be on so that its shunt can be sampled: it turns on a dead time after the
/// compare value, the amplifier settles, and the sample is taken 20 counts before the middle.
const fn sampling_counts(dead_time_ns: u16, settling_ns: u16) -> u16 {
    const LEAD: u32 = 20;
    let ns = dead_time_ns as u32 + settling_ns as u32;
    let before = (ns * 170).div_ceil(1_000) + LEAD;
    // Below 2^16 for whatever fits the arguments: 2 · 22,283.
    2 * before as u16
}

/// NUCLEO-G474RE with X-NUCLEO-IHM08M1: shunts of 0.01 Ω, pulled up by 680 Ω and 6.8 kΩ to 3.3 V, behind a gain of 1 + 4.7/1: 5.18
/// around 1.71 V. Bus divider 169 kΩ over 9.31 kΩ, 3.3 V, 12 bits.
pub const IHM08M1: Hardware = Hardware {
    pwm_hz: 20_000,
    core_hz: 170_000_000,
    timer_top: 4_250,
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
    // The shield's own range begins there (UM1996), and its gate drivers turn on at 9 to 10 V (L6398's data sheet).
    bus_min_v: Si::lit("10"),
    bus_max_v: Si::lit("48"),
    temperature_max_c: Si::lit("110"),
    thermistor: NTC_10K_3455_OVER_4K7,
};

/// B-G431B-ESC1: shunts of 0.003 Ω behind a gain of 64/7 around 2.06 V, bus divider 1:10.39, 3.3 V, 12 bits. The board is for six
/// lithium cells, which have 25.2 V when full.
pub const B_G431B_ESC1: Hardware = Hardware {
    // An amplifier of 13 MHz at a gain of 16.
    sampling_counts: sampling_counts(800, 1_000),
    // 3.3 V / 4,096 / (0.003 Ω · 64/7)
    amps_per_code: Si::lit("-0.029373"),
    // 3.3 V / 4,096 · 10.39
    volts_per_code: Si::lit("0.008371"),
    // 16 · 0.9 V/7 of 3.3 V
    offset_code: 2_553,
    current_max_a: Si::lit("25"),
    // Three cells at 3.3 V: below it the board's own supply of the gate drivers is nowhere stated.
    bus_min_v: Si::lit("10"),
    bus_max_v: Si::lit("26"),
    // As on the shield: the same clock and PWM, a thermistor of the same kind, the same care.
    pwm_hz: IHM08M1.pwm_hz,
    core_hz: IHM08M1.core_hz,
    timer_top: IHM08M1.timer_top,
    offset_tolerance: IHM08M1.offset_tolerance,
    offset_spread: IHM08M1.offset_spread,
    temperature_max_c: IHM08M1.temperature_max_c,
    thermistor: NTC_10K_3455_OVER_4K7,
};

impl Hardware {
    /// The modulator of this timer.
    #[must_use]
    pub const fn modulator(&self) -> Modulator {
        Modulator {
            top: self.timer_top,
            // The low side is on around the timer's top, for the counts above the compare value, up and down again.
            longest: self.timer_top.saturating_sub(self.sampling_counts / 2),
        }
    }

    /// A per code with 28 fractional bits.
    #[must_use]
    pub const fn amps_per_code_bits(&self) -> i32 {
        clamp_i32(self.amps_per_code.to_bits() >> 4)
    }
}
