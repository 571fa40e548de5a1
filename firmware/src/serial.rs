//! The serial port to the desktop: the ST-LINK's virtual port, 921,600 baud, 8N1.

use embassy_stm32::usart;
use static_cell::ConstStaticCell;

/// 115,200 would not carry the telemetry.
pub const BAUD: u32 = 921_600;

/// What waits to be sent: 11 ms of the port.
pub static SEND: ConstStaticCell<[u8; 1024]> = ConstStaticCell::new([0; 1024]);
/// What was received and not yet read.
pub static RECEIVE: ConstStaticCell<[u8; 512]> = ConstStaticCell::new([0; 512]);

/// The port's settings.
pub fn config() -> usart::Config {
    let mut config = usart::Config::default();
    config.baudrate = BAUD;
    config
}
