//! The chip of the NUCLEO-G431RB with the three-phase shield X-NUCLEO-IHM16M1 (STSPIN830); both are sold together as
//! P-NUCLEO-IHM03. Pins and peripherals are in `ihm16m1.rs`.
//!
//! | property | source |
//! |---|---|
//! | functions of the pins and channels of the converters, the same as on the STM32G474 | the vendor's pin database of the STM32G431RB (of its configurator) |
//! | the ST-LINK's serial port at PA2 and PA3, the button at PC13 (high while pressed), SPI3 on the morpho connector | Zephyr's board file for this NUCLEO, which agrees with the NUCLEO-G474RE; UM2505 **not read** for this board |
//!
//! The chip is that of the B-G431B-ESC1 with more pins. It has the same memory map and the same time driver (the chip has no TIM5),
//! and no room for more than one wall.

use embassy_stm32::Peripherals;
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::usart::BufferedUart;

use crate::storage::Storage;

#[path = "ihm16m1.rs"]
mod ihm16m1;
pub use ihm16m1::*;

/// The board for which this program is built; the device reports it to the computer.
pub const BOARD: touchstone_protocol::Board = touchstone_protocol::Board::NucleoG431rbIhm16m1;

/// Sets up every pin and peripheral of the board; the outputs stay off. Returns the serial port to the computer and the settings'
/// flash.
pub fn set_up(p: Peripherals) -> (BufferedUart<'static>, Storage) {
    interrupt::TIM3.set_priority(Priority::P6);
    set_up_pins(p)
}
