//! The PWM timer TIM1: three complementary outputs at 20 kHz, and the trigger that samples the currents.
//!
//! The code writes the registers itself, because embassy-stm32's driver starts the timer with its outputs on (`MOE` set) and its
//! duty setter may panic.

use embassy_stm32::pac::TIM1;
use embassy_stm32::pac::timer::vals::{
    Bkinp, Bkp, Ckd, Cms, FilterValue, Lock, Mms2, Ocm, Ossi, Ossr,
};
use embassy_stm32::peripherals::TIM1 as Timer;
use embassy_stm32::timer::complementary_pwm::ComplementaryPwmPin;
use embassy_stm32::timer::simple_pwm::PwmPin;
use embassy_stm32::timer::{Ch1, Ch2, Ch3};
use embassy_stm32::{Peri, rcc};

use crate::clock::CORE_HZ;

/// Rate of the PWM and of the current loop, Hz.
pub const PWM_HZ: u32 = 20_000;

/// Compare value of full duty, and the largest count. In a PWM period the timer counts up to this value and down again.
pub const FULL_SCALE: u16 = (CORE_HZ / (2 * PWM_HZ)) as u16;

/// Half a PWM period in processor cycles; the timer runs at the processor's clock.
pub const HALF_PERIOD: u32 = FULL_SCALE as u32;

/// Number of timer counts by which the injected conversions start before the middle of the time in which all lower transistors
/// conduct. So the middle lies within the sampling time.
const SAMPLE_LEAD: u16 = 20;

/// The settings of the PWM timer that a board's bridge needs.
#[derive(Debug, Clone, Copy)]
pub struct Bridge {
    /// Dead time between switching one transistor of a phase off and the other on, ns.
    pub dead_time_ns: u32,
    /// How the gate drivers use the timer's complementary outputs.
    pub complement: Complement,
    /// The hardware signal that switches the outputs off without the processor.
    pub break_input: BreakInput,
}

/// How a gate driver uses the timer's complementary output of its phase.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Complement {
    /// The lower transistor is on while the pin is high.
    ActiveHigh,
    /// The lower transistor is on while the pin is low.
    ActiveLow,
    /// The pin enables the phase. While it is high, the other input's level drives the phase; while it is low, both transistors are
    /// off.
    Enable,
}

/// Source of the hardware break that detects over-current.
#[derive(Debug, Clone, Copy)]
pub enum BreakInput {
    /// The pin BKIN, active low, which comparators on the board pull.
    Pin,
    /// Comparators inside the chip, as a bit mask: bit 0 is COMP1. Their inputs are the unfiltered voltages of the shunts, with
    /// spikes from switching. So the break acts only after an uninterrupted over-current of 1.5 us.
    Comparators(u8),
}

/// The dead time as code for the register field BDTR.DTG, rounded up (reference manual RM0440, 28.6.20).
const fn dead_time_code(ns: u32) -> u8 {
    let counts = (ns as u64 * CORE_HZ as u64).div_ceil(1_000_000_000);
    if counts < 128 {
        counts as u8
    } else if counts <= (64 + 63) * 2 {
        0x80 | (counts.div_ceil(2) - 64) as u8
    } else if counts <= (32 + 31) * 8 {
        0xc0 | (counts.div_ceil(8) - 32) as u8
    } else if counts <= (32 + 31) * 16 {
        0xe0 | (counts.div_ceil(16) - 32) as u8
    } else {
        panic!("a dead time of more than 5.9 us")
    }
}

const _: () = {
    assert!(dead_time_code(500) == 85);
    // 800 ns are 136 timer counts: 68 steps of two counts.
    assert!(dead_time_code(800) == 0x80 | 4);
    // 2 µs are 340 timer counts: 43 steps of eight counts.
    assert!(dead_time_code(2_000) == 0xc0 | 11);
    assert!(dead_time_code(5_000) == 0xe0 | 22);
};

/// The pins of the bridge's upper transistors.
pub type HighSides = (
    PwmPin<'static, Timer, Ch1>,
    PwmPin<'static, Timer, Ch2>,
    PwmPin<'static, Timer, Ch3>,
);
/// The pins of the bridge's lower transistors.
pub type LowSides = (
    ComplementaryPwmPin<'static, Timer, Ch1>,
    ComplementaryPwmPin<'static, Timer, Ch2>,
    ComplementaryPwmPin<'static, Timer, Ch3>,
);

/// Leaks the handles of the pins, so that the pins stay connected to the timer until the next reset.
pub fn keep(high: HighSides, low: LowSides) {
    core::mem::forget((high, low));
}

/// Starts the timer with its outputs off, at the levels that the gate drivers read as off. The board connects the pins after this
/// call and passes them to [`keep`].
pub fn start(_timer: Peri<'static, Timer>, bridge: Bridge) {
    rcc::enable_and_reset::<Timer>();
    TIM1.cr1().write(|w| {
        w.set_cms(Cms::CENTER_ALIGNED1);
        w.set_ckd(Ckd::DIV1);
        w.set_arpe(true);
    });
    let inverted = bridge.complement == Complement::ActiveLow;
    // While the timer drives an output whose enable bit is clear, the output is at its inactive level (OSSR); otherwise at its idle
    // level (RM0440, table of the outputs' control bits). So the enable line shows whether the bridge is on, without the processor.
    let enables = bridge.complement == Complement::Enable;
    // Levels of the pins while the outputs are off: upper transistors off. OC4REF triggers the converters.
    TIM1.cr2().write(|w| {
        w.set_mms2(Mms2::COMPARE_OC4);
        for channel in 0..3 {
            w.set_ois(channel, false);
            w.set_oisn(channel, inverted);
        }
    });
    TIM1.psc().write_value(0);
    TIM1.arr().write(|w| w.set_arr(FULL_SCALE));
    TIM1.rcr().write(|w| w.set_rep(0));
    for channel in 0..4 {
        TIM1.ccmr_output(channel / 2).modify(|w| {
            w.set_ocpe(channel % 2, true);
            // Channel 4 triggers the converters. It rises while the counter counts up, just before the top, where all lower
            // transistors conduct.
            w.set_ocm(
                channel % 2,
                if channel == 3 {
                    Ocm::PWM_MODE2
                } else {
                    Ocm::PWM_MODE1
                },
            );
        });
    }
    for channel in 0..3 {
        TIM1.ccr(channel).write(|w| w.set_ccr(FULL_SCALE / 2));
    }
    TIM1.ccr(3).write(|w| w.set_ccr(FULL_SCALE - SAMPLE_LEAD));
    TIM1.ccer().write(|w| {
        for channel in 0..3 {
            w.set_cce(channel, true);
            w.set_ccne(channel, !enables);
            w.set_ccnp(channel, inverted || enables);
        }
    });
    TIM1.af1().write(|w| match bridge.break_input {
        BreakInput::Pin => {
            w.set_bkine(true);
            // Not inverted here, because BDTR sets the polarity.
            w.set_bkinp(Bkinp::NOT_INVERTED);
        }
        BreakInput::Comparators(mask) => {
            for comparator in 0..4 {
                w.set_bkcmpe(comparator, mask >> comparator & 1 != 0);
            }
        }
    });
    TIM1.bdtr().write(|w| {
        w.set_dtg(dead_time_code(bridge.dead_time_ns));
        w.set_ossi(Ossi::IDLE_LEVEL);
        w.set_ossr(Ossr::IDLE_LEVEL);
        w.set_bke(0, true);
        w.set_bkp(
            0,
            match bridge.break_input {
                BreakInput::Pin => Bkp::ACTIVE_LOW,
                BreakInput::Comparators(_) => Bkp::ACTIVE_HIGH,
            },
        );
        w.set_bkf(
            0,
            match bridge.break_input {
                // A break must last 8 timer cycles, which are 47 ns.
                BreakInput::Pin => FilterValue::FCK_INT_N8,
                // A break must last 8 times 32 timer cycles, which are 1.5 µs.
                BreakInput::Comparators(_) => FilterValue::FDTS_DIV32_N8,
            },
        );
        // Only software sets MOE again, and only after a command.
        w.set_aoe(false);
        w.set_moe(false);
        // Dead time, break, polarity and idle levels are locked until a reset; no later write can change them.
        w.set_lock(Lock::LEVEL2);
    });
    // Loads the preloaded registers, then clears the flags that this and the set-up have raised.
    TIM1.egr().write(|w| w.set_ug(true));
    TIM1.sr().write(|_| ());
    TIM1.dier().write(|w| w.set_bie(true));
    TIM1.cr1().modify(|w| w.set_cen(true));
}

/// Switches all outputs off: the timer then holds them at their idle levels.
#[inline(always)]
pub fn outputs_off() {
    TIM1.bdtr().modify(|w| w.set_moe(false));
}

/// Switches the outputs on, unless a break is pending. The timer clears `MOE` again at once while its break input is active.
#[inline(always)]
pub fn outputs_on() {
    TIM1.bdtr().modify(|w| w.set_moe(true));
}

/// Sets the compare values of the three phases, each at most [`FULL_SCALE`]. They take effect when the counter next turns at the
/// bottom.
#[inline(always)]
pub fn set_duty(duty: [u16; 3]) {
    TIM1.ccr(0).write(|w| w.set_ccr(duty[0]));
    TIM1.ccr(1).write(|w| w.set_ccr(duty[1]));
    TIM1.ccr(2).write(|w| w.set_ccr(duty[2]));
}

/// Whether the counter still counts down from the top, where the currents were sampled. If so, the values in the compare registers
/// take effect for all three phases together, at the bottom.
#[inline(always)]
pub fn is_before_bottom() -> bool {
    TIM1.cr1().read().dir() == embassy_stm32::pac::timer::vals::Dir::DOWN
}

/// Whether a break has acted since breaks were last cleared: a break of the break input, or a system break. A system break comes
/// from low supply, a processor lockup or an uncorrectable flash error, and has its own flag.
#[inline(always)]
pub fn is_broken() -> bool {
    let status = TIM1.sr().read();
    status.bif(0) || status.sbif()
}

/// Whether the break input has acted since it was last cleared. The system break (supply, lockup, flash error) does not count.
#[inline(always)]
pub fn is_input_broken() -> bool {
    TIM1.sr().read().bif(0)
}

/// Disables the break's interrupt; its flag stays set. The timer has no other interrupt enabled.
#[inline(always)]
pub fn silence_break() {
    TIM1.dier().write(|_| ());
}

/// Clears the flags of input break and system break, and enables the break's interrupt. A flag is set again at once if its cause is
/// still present. While the system break's flag is set, the timer does not accept `MOE` (RM0440, TIM1_SR.SBIF).
pub fn clear_break() {
    // The register is written without reading it first, because a zero clears a flag and a one has no effect.
    TIM1.sr().write(|w| {
        w.0 = !0;
        w.set_bif(0, false);
        w.set_sbif(false);
    });
    TIM1.dier().write(|w| w.set_bie(true));
}
