//! 170 MHz for everything, from the oscillator inside.
//!
//! Its 1 % is enough: the control period enters the law's bounds with the same 1 %, and a serial port bears 2 %. An oscillator
//! that is inside the chip works on every board and cannot come loose.

use embassy_stm32::Config;
use embassy_stm32::interrupt::Priority;
use embassy_stm32::rcc::{Pll, PllMul, PllPreDiv, PllRDiv, PllSource, Sysclk, mux};

/// Processor, buses and timers, Hz.
pub const CORE_HZ: u32 = 170_000_000;

/// What `embassy_stm32::init` sets up.
pub fn config() -> Config {
    let mut config = Config::default();
    config.rcc.hsi = true;
    config.rcc.hsi48 = None;
    config.rcc.pll = Some(Pll {
        source: PllSource::HSI,
        // 16 MHz / 4 * 85 / 2.
        prediv: PllPreDiv::DIV4,
        mul: PllMul::MUL85,
        divp: None,
        divq: None,
        divr: Some(PllRDiv::DIV2),
    });
    config.rcc.sys = Sysclk::PLL1_R;
    config.rcc.boost = true;
    // Both pairs of converters from the same clock, as the errata sheet asks (ES0430 2.7.11).
    config.rcc.mux.adc12sel = mux::Adcsel::SYS;
    config.bdma_interrupt_priority = Priority::P6;
    config
}
