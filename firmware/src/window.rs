//! The window watchdog: resets the chip if the current loop falls silent.
//!
//! A current loop that hangs leaves the last duty at the bridge: the field stands still while the shaft turns, and nobody looks
//! at the currents. No interrupt can end it, as none is above it. The independent watchdog ([`crate::watchdog`]) would, after
//! 100 ms; this one does after five PWM periods, a quarter of a control tick at 1 kHz. It is refreshed at the end of each
//! run of the current loop, so that it also bites when the timer or the converters no longer call it.
//!
//! It counts the bus clock, which the loop itself runs by; a clock that fails is the independent watchdog's. Its window is not
//! used: a current loop that comes too often would be called by a timer set up wrongly, and nothing sets it up again.

use embassy_stm32::pac::WWDG;
use embassy_stm32::pac::wwdg::vals::Wdgtb;
use embassy_stm32::{peripherals, rcc};

use crate::clock::CORE_HZ;

/// Cycles of the bus clock, which is the processor's, in a count (reference manual RM0440, 43.3.4).
const CYCLES_PER_COUNT: u32 = 4_096;
/// Counts to the reset, at least: where between two counts a refresh comes is not known, so that it may be one more.
///
/// 241 to 265 us: longer than anything that may hold the current loop up while it drives, which is nothing; than a double word
/// of settings being programmed, 91 us with the processor stalled; and, 128 times as long, than a page being erased.
const COUNTS: u32 = 10;
/// The counter resets the chip when it falls below.
const LAST: u32 = 0x40;
/// Longest time in which the processor stands still while a page is erased, us (data sheet DS12288, table 49: 24.47 ms).
const ERASE_US: u32 = 24_470;

const _: () = {
    assert!(LAST + COUNTS <= 0x7f);
    let us = COUNTS * CYCLES_PER_COUNT / (CORE_HZ / 1_000_000);
    assert!(us == 240);
    assert!(us * 128 > ERASE_US + ERASE_US / 5);
};

/// Starts it; nothing but a reset stops it. The current loop's interrupt is enabled.
pub fn start() {
    rcc::enable_and_reset::<peripherals::WWDG>();
    set_share(Wdgtb::DIV1);
    refresh();
}

/// Another [`COUNTS`].
#[inline(always)]
pub fn refresh() {
    WWDG.cr().write(|w| {
        w.set_wdga(true);
        w.set_t((LAST + COUNTS) as u8);
    });
}

/// Does something for which the processor stands still, with the outputs off: 31 to 34 ms until the reset meanwhile.
pub fn extended<R>(erase: impl FnOnce() -> R) -> R {
    set_share(Wdgtb::DIV128);
    // The counter may have fallen since the current loop's last refresh.
    refresh();
    let result = erase();
    refresh();
    set_share(Wdgtb::DIV1);
    result
}

/// Divides the watchdog's clock; no closed window.
fn set_share(share: Wdgtb) {
    WWDG.cfr().write(|w| {
        w.set_w(0x7f);
        w.set_wdgtb(share);
    });
}
