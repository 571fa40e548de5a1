//! What both boards do after their pins are set up.

use embassy_executor::Spawner;
use embassy_stm32::usart::BufferedUart;
use embassy_time::{Duration, Ticker, Timer};
use embedded_io_async::{Read, Write};

use crate::{interrupts, watchdog};

/// A board, set up.
pub struct Board {
    /// The link to the desktop.
    pub serial: BufferedUart<'static>,
}

/// The program after the board's set-up; ends with the next reset.
pub async fn run(spawner: Spawner, board: Board) -> ! {
    watchdog::start();
    interrupts::start();
    if let Ok(token) = link(board.serial) {
        spawner.spawn(token);
    }
    let mut ticker = Ticker::every(Duration::from_millis(10));
    loop {
        watchdog::feed();
        ticker.next().await;
    }
}

#[embassy_executor::task]
async fn link(mut serial: BufferedUart<'static>) {
    let mut buffer = [0; 64];
    loop {
        match serial.read(&mut buffer).await {
            Ok(count) => {
                let _ = serial.write_all(&buffer[..count]).await;
            }
            Err(_) => Timer::after_millis(1).await,
        }
    }
}
