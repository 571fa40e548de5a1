//! The independent watchdog: resets the chip when the supervision task does not feed it.
//!
//! Its clock, the LSI, has nominally 32 kHz, and 29.5 to 34 kHz over temperature and supply (data sheet DS12288, table 47). With
//! the slowest clock the reset must still come in time. With the fastest clock no reset may come while the supervision task feeds
//! the watchdog in time.

use embassy_stm32::pac::IWDG;
use embassy_stm32::pac::iwdg::vals::{Key, Pr};
use embassy_time::Duration;

/// Time between two checks by the supervision task, which feeds the watchdog.
pub const SUPERVISION: Duration = Duration::from_millis(10);

/// Lowest and highest frequency of the LSI clock, Hz.
const LSI_HZ: (u32, u32) = (29_500, 34_000);

/// LSI cycles per count of the watchdog.
const PRESCALER: u32 = 16;

/// Longest time from the last feeding to the reset, ms. An erase of a flash page stalls the processor for up to 25 ms on the
/// single-bank chip; the supervision task feeds the watchdog every 10 ms.
const LONGEST_MS: u32 = 100;

/// Number of watchdog counts from a feeding to the reset.
const RELOAD: u32 = LONGEST_MS * LSI_HZ.0 / 1_000 / PRESCALER;

const _: () = {
    assert!(RELOAD <= 0xfff);
    // Shortest time to a reset, ms. It must exceed three feeding intervals of 10 ms with two page erases of 25 ms among them.
    assert!(RELOAD * PRESCALER * 1_000 / LSI_HZ.1 > 80);
};

/// Starts the watchdog; only a reset stops it.
pub fn start() {
    IWDG.kr().write(|w| w.set_key(Key::START));
    IWDG.kr().write(|w| w.set_key(Key::ENABLE));
    IWDG.pr().write(|w| w.set_pr(Pr::DIVIDE_BY16));
    IWDG.rlr().write(|w| w.set_rl(RELOAD as u16));
    feed();
}

/// Restarts the watchdog's count: the reset comes at most [`LONGEST_MS`] later.
pub fn feed() {
    IWDG.kr().write(|w| w.set_key(Key::RESET));
}
