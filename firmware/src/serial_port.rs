//! Rate and buffers of the serial port to the computer.

use embassy_stm32::usart;
use static_cell::ConstStaticCell;

/// Rate of the serial port, baud. 115,200 is too slow for the telemetry.
pub const BAUD: u32 = 921_600;

/// Buffer of bytes that wait to be sent; the port sends them in 8 ms.
pub static SEND: ConstStaticCell<[u8; 768]> = ConstStaticCell::new([0; 768]);
/// Buffer of received bytes that the task has not read yet; the port receives as many in 5 ms.
pub static RECEIVE: ConstStaticCell<[u8; 512]> = ConstStaticCell::new([0; 512]);

/// Settings of the serial port.
pub fn config() -> usart::Config {
    let mut config = usart::Config::default();
    config.baudrate = BAUD;
    config
}
