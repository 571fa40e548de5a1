//! NUCLEO-G431RB with the three-phase shield X-NUCLEO-IHM16M1 (STSPIN830), which are sold together as P-NUCLEO-IHM03: what is the chip's. Pins
//! and peripherals are in `ihm16m1.rs`.
//!
//! | what | from |
//! |---|---|
//! | the pins' functions and the converters' channels: as on the larger chip | the vendor's description of the STM32G431RB's pins (the pins' database of its configurator) |
//! | the serial port of the ST-LINK at PA2 and PA3, the button at PC13, high while pressed, SPI3 on the morpho connector | Zephyr's board file for this NUCLEO, which agrees with what the other one has; UM2505 **not read** for this one |
//!
//! The chip is the B-G431B-ESC1's with more pins: its memory's map, its time driver (there is no TIM5), and no room for more than one wall.

use embassy_stm32::Peripherals;
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::usart::BufferedUart;

use crate::storage::Storage;

#[path = "ihm16m1.rs"]
mod ihm16m1;
pub use ihm16m1::*;

/// The board's name for the desktop.
pub const BOARD: touchstone_protocol::Board = touchstone_protocol::Board::NucleoG431rbIhm16m1;

/// Sets up every pin and peripheral of the board; outputs stay off. The link to the desktop, and where settings are kept.
pub fn set_up(p: Peripherals) -> (BufferedUart<'static>, Storage) {
    interrupt::TIM3.set_priority(Priority::P6);
    set_up_pins(p)
}
