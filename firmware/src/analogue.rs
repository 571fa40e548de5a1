//! The analogue command to an external servo amplifier: DAC1 channel 1, and a pin of port C that enables the amplifier.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use embassy_stm32::pac::dac::vals::Mode;
use embassy_stm32::pac::{DAC1, GPIOC};
use embassy_stm32::{Peri, peripherals, rcc};
use touchstone_drive::DacCode;

/// The pin of port C that enables the amplifier, as a mask; none where the board has no such output.
static ENABLE: AtomicU32 = AtomicU32::new(0);

/// Sets it up at the middle, which is no torque. The pin is analogue after a reset already, and is not driven before the first
/// command: without such an amplifier the shield has a potentiometer there.
pub fn start(_dac: Peri<'static, peripherals::DAC1>, enable: u8) {
    ENABLE.store(1 << enable, Relaxed);
    rcc::enable_and_reset::<peripherals::DAC1>();
    // RM0440: above 160 MHz of bus clock.
    DAC1.mcr().write(|w| {
        w.set_hfsel(2);
        w.set_mode(0, Mode::NORMAL_EXT_BUFEN);
    });
    set(DacCode::ZERO);
}

/// The amplifier off, its command in the middle.
#[inline]
pub fn off() {
    enable(false);
    set(DacCode::ZERO);
}

/// The amplifier on, with this command. The first one is no torque, as it fades in, while the converter wakes up (8 us).
#[inline]
pub fn on(code: DacCode) {
    set(code);
    DAC1.cr().write(|w| w.set_en(0, true));
    enable(true);
}

/// The upper half of the register clears.
#[inline(always)]
fn enable(on: bool) {
    let pin = ENABLE.load(Relaxed);
    GPIOC
        .bsrr()
        .write(|w| w.0 = if on { pin } else { pin << 16 });
}

#[inline(always)]
fn set(code: DacCode) {
    DAC1.dhr12r(0).write(|w| w.set_dhr(code.0 & 0xfff));
}
