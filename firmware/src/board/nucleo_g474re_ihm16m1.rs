//! NUCLEO-G474RE with the three-phase shield X-NUCLEO-IHM16M1 (STSPIN830): what is the chip's. Pins and peripherals are in `ihm16m1.rs`.

use embassy_stm32::Peripherals;
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::usart::BufferedUart;

use crate::storage::Storage;

#[path = "ihm16m1.rs"]
mod ihm16m1;
pub use ihm16m1::*;

/// The board's name for the desktop.
pub const BOARD: touchstone_protocol::Board = touchstone_protocol::Board::NucleoG474reIhm16m1;

/// Sets up every pin and peripheral of the board; outputs stay off. The link to the desktop, and where settings are kept.
pub fn set_up(p: Peripherals) -> (BufferedUart<'static>, Storage) {
    interrupt::TIM5.set_priority(Priority::P6);
    set_up_pins(p)
}
