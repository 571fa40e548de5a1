//! The window watchdog: resets the chip when the current loop stops running.
//!
//! If the current loop hangs, the bridge keeps its last duty: the motor's field stands still while the shaft turns, and no code
//! checks the currents. No interrupt can end the hang, because the current loop has the highest priority. The independent watchdog
//! ([`crate::watchdog`]) resets only after 100 ms.
//!
//! The window watchdog resets after five PWM periods, a quarter of a control period at 1 kHz. Each run of the current loop
//! refreshes the watchdog at its end. So the chip also resets when timer or converters no longer start the current loop.
//!
//! The watchdog counts the bus clock, from which the PWM timer runs too; the independent watchdog covers a failure of that clock.
//! The window against too early refreshes is not used: only a wrongly configured timer would run the current loop too often, and no
//! code configures the timer again.

use embassy_stm32::pac::WWDG;
use embassy_stm32::pac::wwdg::vals::Wdgtb;
use embassy_stm32::{peripherals, rcc};

use crate::clock::CORE_HZ;

/// Cycles of the bus clock, which equals the processor's clock, per count of the watchdog (reference manual RM0440, 43.3.4).
const CYCLES_PER_COUNT: u32 = 4_096;
/// Least number of the watchdog's counts from a refresh to the reset. The actual number can be one more, because a refresh may
/// come at any time between two counts.
///
/// The reset comes 241 to 265 us after the last refresh. This is longer than any delay of the current loop: none while the
/// outputs are on, 91 us while a double word of settings is programmed and the processor stalls. During the erase of a page the
/// time to the reset is 128 times as long.
const COUNTS: u32 = 10;
/// The watchdog resets the chip when its counter falls below this value.
const LAST: u32 = 0x40;
/// Longest stall of the processor while a page is erased, us (data sheet DS12288, table 49: 24.47 ms).
const ERASE_US: u32 = 24_470;

const _: () = {
    assert!(LAST + COUNTS <= 0x7f);
    let us = COUNTS * CYCLES_PER_COUNT / (CORE_HZ / 1_000_000);
    assert!(us == 240);
    assert!(us * 128 > ERASE_US + ERASE_US / 5);
};

/// Starts the watchdog; only a reset stops it. The current loop's interrupt must be enabled before.
pub fn start() {
    rcc::enable_and_reset::<peripherals::WWDG>();
    set_share(Wdgtb::DIV1);
    refresh();
}

/// Restarts the watchdog's count at [`COUNTS`].
#[inline(always)]
pub fn refresh() {
    WWDG.cr().write(|w| {
        w.set_wdga(true);
        w.set_t((LAST + COUNTS) as u8);
    });
}

/// Calls `erase`, which stalls the processor, with the watchdog's time extended to 31 to 34 ms. The outputs must be off.
pub fn extended<R>(erase: impl FnOnce() -> R) -> R {
    set_share(Wdgtb::DIV128);
    // Needed, because the counter has counted down since the current loop's last refresh.
    refresh();
    let result = erase();
    refresh();
    set_share(Wdgtb::DIV1);
    result
}

/// Sets the divider of the watchdog's clock, and allows a refresh at any time.
fn set_share(share: Wdgtb) {
    WWDG.cfr().write(|w| {
        w.set_w(0x7f);
        w.set_wdgtb(share);
    });
}
