//! The chip of the NUCLEO-G474RE with the three-phase shield X-NUCLEO-IHM16M1 (STSPIN830). Pins and peripherals are in
//! `ihm16m1.rs`.

use embassy_stm32::Peripherals;
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::usart::BufferedUart;

use crate::storage::Storage;

#[path = "ihm16m1.rs"]
mod ihm16m1;
pub use ihm16m1::*;

/// The board for which this program is built; the device reports it to the computer.
pub const BOARD: touchstone_protocol::Board = touchstone_protocol::Board::NucleoG474reIhm16m1;

/// Sets up every pin and peripheral of the board; the outputs stay off. Returns the serial port to the computer and the settings'
/// flash.
pub fn set_up(p: Peripherals) -> (BufferedUart<'static>, Storage) {
    interrupt::TIM5.set_priority(Priority::P6);
    set_up_pins(p)
}
