//! The injected conversions of the converters ADC1 and ADC2, which the timer TIM1 triggers at the same time.

use embassy_stm32::adc::{Adc, AnyAdcChannel, Exten, SampleTime};
use embassy_stm32::pac::{ADC1, ADC2};
use embassy_stm32::peripherals;
use embassy_stm32::triggers::TIM1_TRGO2;

/// The converters' readings for the current loop and the supervisor, in 12-bit codes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Readings {
    /// Code for the current of phase A.
    pub phase_a: u16,
    /// Code for the current of phase B.
    pub phase_b: u16,
    /// Code for the bus voltage.
    pub bus: u16,
    /// Code for the temperature of the power stage.
    pub temperature: u16,
}

/// The results of one set of conversions, in the order of the board's channels. `RANKS` is the number of conversions per converter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Raw<const RANKS: usize> {
    /// Results of ADC1, 0 to 4095.
    pub first: [u16; RANKS],
    /// Results of ADC2, 0 to 4095.
    pub second: [u16; RANKS],
}

/// Sample time for a current: 0.15 us of sampling at 42.5 MHz, then 0.29 us of conversion. In the sequence the currents come before
/// the slower signals.
pub const FAST: SampleTime = SampleTime::CYCLES6_5;
/// Sample time for a current behind one of the chip's own amplifiers: 0.29 us of sampling.
pub const AMPLIFIED: SampleTime = SampleTime::CYCLES12_5;
/// Sample time for bus voltage and temperature: long, because they come from voltage dividers of some 10 kohm.
pub const SLOW: SampleTime = SampleTime::CYCLES47_5;

/// Starts ADC1 and ADC2. They run until the next reset: the function gives up their handles, because dropping a handle would stop
/// its converter.
pub fn start<const RANKS: usize>(
    first: Adc<'static, peripherals::ADC1>,
    first_channels: [(AnyAdcChannel<'static, peripherals::ADC1>, SampleTime); RANKS],
    second: Adc<'static, peripherals::ADC2>,
    second_channels: [(AnyAdcChannel<'static, peripherals::ADC2>, SampleTime); RANKS],
) {
    // ADC2 starts first and without an interrupt. Both converters are triggered together and take the same time, so ADC1's end of
    // sequence stands for both.
    let second =
        second.setup_injected_conversions(second_channels, TIM1_TRGO2, Exten::RISING_EDGE, false);
    core::mem::forget(second);
    start_first(first, first_channels);
}

/// Starts ADC1 alone, which interrupts at the end of its sequence.
pub fn start_first<const RANKS: usize>(
    first: Adc<'static, peripherals::ADC1>,
    first_channels: [(AnyAdcChannel<'static, peripherals::ADC1>, SampleTime); RANKS],
) {
    let first =
        first.setup_injected_conversions(first_channels, TIM1_TRGO2, Exten::RISING_EDGE, true);
    core::mem::forget(first);
}

/// Reads the results of a finished set of conversions and clears the flags of ADC1 and ADC2.
#[inline(always)]
pub fn take<const RANKS: usize>() -> Raw<RANKS> {
    let raw = Raw {
        first: take_first(),
        second: core::array::from_fn(|rank| ADC2.jdr(rank).read().jdata()),
    };
    ADC2.isr().write(|w| {
        w.set_jeos(true);
        w.set_jeoc(true);
    });
    raw
}

/// Reads ADC1's results of a finished set of conversions and clears its flags.
#[inline(always)]
pub fn take_first<const RANKS: usize>() -> [u16; RANKS] {
    let codes = core::array::from_fn(|rank| ADC1.jdr(rank).read().jdata());
    // Writing ones clears the flags, JEOC among them.
    ADC1.isr().write(|w| {
        w.set_jeos(true);
        w.set_jeoc(true);
    });
    codes
}
