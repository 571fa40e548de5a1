//! The analogue command to an external servo amplifier: a voltage from DAC1 channel 1, and a pin of port C that enables the
//! amplifier.

use core::sync::atomic::{AtomicU32, Ordering::Relaxed};

use embassy_stm32::pac::dac::vals::Mode;
use embassy_stm32::pac::{DAC1, GPIOC};
use embassy_stm32::{Peri, peripherals, rcc};
use touchstone_drive::DacCode;

/// Bit mask of the pin of port C that enables the amplifier; 0 before [`start`], and on boards without this output.
static ENABLE: AtomicU32 = AtomicU32::new(0);

/// Sets the converter up with its output at half scale, which means no torque. The DAC's pin is analogue after a reset and stays
/// undriven until the first command. So it does not drive the shield's potentiometer, which is connected to this pin if no servo
/// amplifier is used.
pub fn start(_dac: Peri<'static, peripherals::DAC1>, enable: u8) {
    ENABLE.store(1 << enable, Relaxed);
    rcc::enable_and_reset::<peripherals::DAC1>();
    // Needed above a bus clock of 160 MHz (RM0440).
    DAC1.mcr().write(|w| {
        w.set_hfsel(2);
        w.set_mode(0, Mode::NORMAL_EXT_BUFEN);
    });
    set(DacCode::ZERO);
}

/// Switches the amplifier off and sets its command to the middle (no torque).
#[inline]
pub fn off() {
    enable(false);
    set(DacCode::ZERO);
}

/// Switches the amplifier on and sets its command to `code`. The converter needs 8 us to wake up. This has no effect on the torque,
/// because the first command is no torque: the torque fades in.
#[inline]
pub fn on(code: DacCode) {
    set(code);
    DAC1.cr().write(|w| w.set_en(0, true));
    enable(true);
}

/// Drives the enable pin. In the register BSRR the upper 16 bits clear a pin and the lower 16 bits set it.
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
