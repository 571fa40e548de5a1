//! Watches the processor's own supply voltage. Below 2.9 V hardware and software switch the outputs off, before the chip resets
//! itself at 1.7 to 2.8 V.

use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::pac::{DBGMCU, EXTI, PWR, SYSCFG};

/// Code of the voltage detector's highest threshold, 2.9 V (data sheet DS12288, PVD level 6).
const LEVEL: u8 = 6;
/// Number of the external interrupt line of the voltage detector.
const LINE: usize = 16;

/// Starts the voltage detector. Also connects to the timer's break the conditions that may stop the processor before it can react:
/// low supply, a lockup (a fault within a fault), an uncorrectable flash error.
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
    // SAFETY: the handler of this interrupt shares only atomics with other code.
    unsafe { interrupt::PVD_PVM.enable() };
    // When a debugger halts the processor, the timer stops with its outputs inactive, and the watchdogs wait.
    DBGMCU.apb2fzr().modify(|w| w.set_tim1(true));
    DBGMCU.apb1lfzr().modify(|w| {
        w.set_iwdg(true);
        w.set_wwdg(true);
    });
}

/// Clears the flag of the interrupt for low supply.
#[inline]
pub fn take() {
    EXTI.pr(0).write(|w| w.set_line(LINE, true));
}
