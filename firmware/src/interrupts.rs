//! The three interrupts that do the work, and nothing that could make them wait or panic.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::NVIC;
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};

use crate::{pwm, sense};

/// PWM periods since the start; wraps.
pub static PERIODS: AtomicU32 = AtomicU32::new(0);
/// Control ticks since the start; wraps.
pub static TICKS: AtomicU32 = AtomicU32::new(0);
/// PWM periods of a control tick.
pub static DIVIDER: AtomicU32 = AtomicU32::new(pwm::PWM_HZ / 1_000);

/// Priorities of the three, then they may come.
pub fn start() {
    interrupt::ADC1_2.set_priority(Priority::P0);
    interrupt::TIM1_BRK_TIM15.set_priority(Priority::P1);
    interrupt::LPTIM1.set_priority(Priority::P2);
    // SAFETY: their handlers are below and share nothing but atomics with other code.
    unsafe {
        interrupt::TIM1_BRK_TIM15.enable();
        interrupt::LPTIM1.enable();
        interrupt::ADC1_2.enable();
    }
}

/// Priority 0, once a PWM period: the currents are there.
#[interrupt]
fn ADC1_2() {
    let _raw = sense::take();
    let period = PERIODS.load(Ordering::Relaxed).wrapping_add(1);
    PERIODS.store(period, Ordering::Relaxed);
    if period % DIVIDER.load(Ordering::Relaxed).max(1) == 0 {
        NVIC::pend(interrupt::LPTIM1);
    }
}

/// Priority 1: the hardware has switched the outputs off.
#[interrupt]
fn TIM1_BRK_TIM15() {
    pwm::take_break();
}

/// Priority 2, one control tick. No timer raises it: the current loop pends it.
#[interrupt]
fn LPTIM1() {
    TICKS.store(
        TICKS.load(Ordering::Relaxed).wrapping_add(1),
        Ordering::Relaxed,
    );
}
