//! The processor's own supply: below 2.9 V the outputs are off, in hardware and in software, before the reset at 1.7 to 2.8 V.

use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::pac::{DBGMCU, EXTI, PWR, SYSCFG};

/// The voltage detector's highest threshold, 2.9 V (data sheet DS12288, PVD level 6).
const LEVEL: u8 = 6;
/// The supply monitor's line of the external interrupts.
const LINE: usize = 16;

/// Watches the supply. It also wires conditions to the timer's break that the processor may not survive to report: a
/// sagging supply, a lockup (a fault within a fault), an error in flash that cannot be corrected.
pub fn start() {
    PWR.cr2().modify(|w| {
        w.set_pls(LEVEL);
        w.set_pvde(true);
    });
    SYSCFG.cfgr2().write(|w| {
        w.set_cll(true);
        w.set_pvdl(true);
        w.set_eccl(true);
    });
    // The detector's output rises when the supply falls.
    EXTI.rtsr(0).modify(|w| w.set_line(LINE, true));
    EXTI.imr(0).modify(|w| w.set_line(LINE, true));
    interrupt::PVD_PVM.set_priority(Priority::P1);
    // SAFETY: its handler shares nothing but atomics with other code.
    unsafe { interrupt::PVD_PVM.enable() };
    // A debugger that halts the processor: the timer stops with its outputs inactive, the watchdogs wait.
    DBGMCU.apb2fzr().modify(|w| w.set_tim1(true));
    DBGMCU.apb1lfzr().modify(|w| {
        w.set_iwdg(true);
        w.set_wwdg(true);
    });
}

/// Takes the interrupt's flag.
#[inline]
pub fn take() {
    EXTI.pr(0).write(|w| w.set_line(LINE, true));
}
