//! The program for a NUCLEO-G431RB with an X-NUCLEO-IHM16M1.
#![no_std]
#![no_main]

use embassy_executor::Spawner;
use touchstone_firmware::{board, clock, run};

#[embassy_executor::main]
async fn main(spawner: Spawner) {
    let peripherals = embassy_stm32::init(clock::config());
    let (serial, storage) = board::set_up(peripherals);
    run::run(spawner, serial, storage).await
}
