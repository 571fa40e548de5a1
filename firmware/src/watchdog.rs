//! The independent watchdog: resets the chip if the supervisor falls silent.
//!
//! Its clock, the LSI, is 32 kHz nominally and may be anything from 29.5 to 34 kHz over temperature and supply (data sheet
//! DS12288, table 47). A reset must come even at the slowest, and never while the supervisor is fed in time at the fastest.

use embassy_stm32::pac::IWDG;
use embassy_stm32::pac::iwdg::vals::{Key, Pr};

/// Slowest and fastest LSI, Hz.
const LSI_HZ: (u32, u32) = (29_500, 34_000);

/// LSI cycles of one count.
const PRESCALER: u32 = 16;

/// The chip is reset at most this long after the last feeding, ms. An erase of a flash page stalls the processor for up to
/// 25 ms on the single-bank chip; feeding comes every 10 ms.
const LONGEST_MS: u32 = 100;

/// Counts from a feeding to the reset.
const RELOAD: u32 = LONGEST_MS * LSI_HZ.0 / 1_000 / PRESCALER;

const _: () = {
    assert!(RELOAD <= 0xfff);
    // Shortest time to a reset: more than three feedings that come late behind two erased pages.
    assert!(RELOAD * PRESCALER * 1_000 / LSI_HZ.1 > 80);
};

/// Starts it; nothing but a reset stops it.
pub fn start() {
    IWDG.kr().write(|w| w.set_key(Key::START));
    IWDG.kr().write(|w| w.set_key(Key::ENABLE));
    IWDG.pr().write(|w| w.set_pr(Pr::DIVIDE_BY16));
    IWDG.rlr().write(|w| w.set_rl(RELOAD as u16));
    feed();
}

/// Another [`LONGEST_MS`], at most.
pub fn feed() {
    IWDG.kr().write(|w| w.set_key(Key::RESET));
}
