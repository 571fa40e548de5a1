//! The clock of 170 MHz for processor, buses and timers, from the chip's internal oscillator.
//!
//! The oscillator's error of 1 % is small enough: the control law's bounds allow 1 % for the control period, and a serial port
//! tolerates 2 %. An internal oscillator works on every board and has no connection that can break.
//!
//! For a switch to more than 80 MHz, the reference manual RM0440, 7.2.7, recommends 1 µs or more at half the frequency after the
//! switch. `embassy-stm32` 0.6 waits before the switch instead: a single write selects the PLL and removes the prescaler of 2. It
//! has no option to change that. If it left the prescaler for this crate to remove, its time driver would run at twice its rate,
//! because it keeps the frequencies of its own set-up.

use embassy_stm32::Config;
use embassy_stm32::interrupt::Priority;
use embassy_stm32::rcc::{Pll, PllMul, PllPreDiv, PllRDiv, PllSource, Sysclk, mux};

/// Clock frequency of processor, buses and timers, Hz.
pub const CORE_HZ: u32 = 170_000_000;

/// The clock configuration that `embassy_stm32::init` sets up.
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
    // Both pairs of converters need the same clock (errata sheet ES0430, 2.7.11).
    config.rcc.mux.adc12sel = mux::Adcsel::SYS;
    config.bdma_interrupt_priority = Priority::P6;
    config
}
