//! Pins and peripherals of a NUCLEO with 64 pins and the three-phase shield X-NUCLEO-IHM16M1 (STSPIN830). They are the same on the
//! NUCLEO-G474RE and the NUCLEO-G431RB, which have the same circuit board (UM2505 describes both).
//!
//! | pins | source |
//! |---|---|
//! | inputs and enables of the phases, currents, bus voltage | NuttX's page and board file, and an open project with the NUCLEO-G474RE and this shield, which agree; the shield's manual UM2415 and schematic **not read** |
//! | currents of phases U and V | two of three sources; NuttX's code swaps U and V. With swapped currents no current reaches its command, which ends in fault 10. ST's own project for the kit reads PB11 and PA7 for V and W: solder links on the shield may differ |
//! | EN\FAULT at PB12 (link R37) or PA11 (link R35) | the open project: shields differ, so the program watches both pins |
//! | the current limiter's reference at PB4, the thermistor at PC4 | NuttX's page; the meaning of the levels **not read** |
//! | functions of the enable pins: TIM1_CH1N, CH2N, CH3N | the chip's data sheet DS12288, from memory |
//!
//! Nothing was measured on a board.

use core::sync::atomic::{AtomicBool, Ordering::Relaxed};

use embassy_stm32::Peripherals;
use embassy_stm32::adc::{Adc, AdcChannel};
use embassy_stm32::gpio::{AfType, Flex, Level, Output, OutputType, Pull, Speed};
use embassy_stm32::pac::gpio::vals::Idr;
use embassy_stm32::pac::{GPIOA, GPIOB};
use embassy_stm32::timer::complementary_pwm::ComplementaryPwmPin;
use embassy_stm32::timer::simple_pwm::PwmPin;
use embassy_stm32::usart::BufferedUart;
use touchstone_drive::{Hardware, hardware};

#[path = "nucleo64.rs"]
mod nucleo64;
pub use crate::magnetic;
pub use nucleo64::{encoder_count, is_stop_pressed};

use crate::pwm::{BreakInput, Bridge, Complement};
use crate::sense::Readings;
use crate::storage::Storage;
use crate::{pwm, sense};

/// Constants of the shield's power stage and sensors.
pub const HARDWARE: Hardware = hardware::IHM16M1;

/// Settings of the PWM timer. The driver STSPIN830 has an input and an enable for each phase, and adds its own dead time. Its line
/// EN\FAULT is the hardware break.
const BRIDGE: Bridge = Bridge {
    dead_time_ns: 0,
    complement: Complement::Enable,
    break_input: BreakInput::Pin,
};

/// Number of the alternate function TIM1_BKIN at pin PB12.
const BREAK_FUNCTION: u8 = 6;

/// Pin numbers of the line EN\FAULT: on port B, and on port A.
const FAULT_LINE: (usize, usize) = (12, 11);

/// Sets up every pin and peripheral; the outputs stay off. The caller has yet to set the priority of the time driver's interrupt.
/// Returns the serial port to the computer and the flash of the settings.
pub fn set_up_pins(p: Peripherals) -> (BufferedUart<'static>, Storage) {
    // An open-drain line that is both error output and enable: pulled up here, pulled down by the driver. Of the two pins, the one
    // that no solder link connects to the line stays high.
    let mut fault_line = (Flex::new(p.PB12), Flex::new(p.PA11));
    fault_line
        .0
        .set_as_af_unchecked(BREAK_FUNCTION, AfType::input(Pull::Up));
    fault_line.1.set_as_input(Pull::Up);
    // The driver's own current limiter must not act, so its reference is at the maximum.
    let limiter = Output::new(p.PB4, Level::High, Speed::Low);
    pwm::start(p.TIM1, BRIDGE);
    pwm::keep(
        (
            PwmPin::new(p.PA8, OutputType::PushPull),
            PwmPin::new(p.PA9, OutputType::PushPull),
            PwmPin::new(p.PA10, OutputType::PushPull),
        ),
        (
            ComplementaryPwmPin::new(p.PB13, OutputType::PushPull),
            ComplementaryPwmPin::new(p.PB14, OutputType::PushPull),
            ComplementaryPwmPin::new(p.PB15, OutputType::PushPull),
        ),
    );
    nucleo64::set_up_stop_button(p.PC13);
    nucleo64::set_up_tracks(p.PA15, p.PB3);
    nucleo64::set_up_spi(p.SPI3, p.PC10, p.PC11, p.PC12, p.PD2);
    // The pins stay as they are until the next reset.
    core::mem::forget((fault_line, limiter));
    // Both currents are sampled at the same time, one by each converter.
    sense::start(
        Adc::new(p.ADC1, Default::default()),
        [
            (p.PB1.degrade_adc(), sense::FAST),
            (p.PA0.degrade_adc(), sense::SLOW),
        ],
        Adc::new(p.ADC2, Default::default()),
        [
            (p.PA1.degrade_adc(), sense::FAST),
            (p.PC4.degrade_adc(), sense::SLOW),
        ],
    );
    let serial = nucleo64::serial_port(p.LPUART1, p.PA3, p.PA2);
    (serial, Storage::new(p.FLASH))
}

/// Assigns the results of a finished set of conversions to phases A and B, bus voltage and temperature. The third phase's current
/// is the negative sum of the two.
#[inline(always)]
pub fn readings() -> Readings {
    let raw = sense::take();
    let [phase_b, bus] = raw.first;
    let [phase_a, temperature] = raw.second;
    Readings {
        phase_a,
        phase_b,
        bus,
        temperature,
    }
}

/// Whether the line EN\FAULT was low at PA11 since [`forget_driver`].
static COMPLAINED: AtomicBool = AtomicBool::new(false);

/// Whether the driver has pulled its line EN\FAULT since [`forget_driver`]. At PB12 no pulse is missed, because the hardware break
/// latches it. At PA11 the current loop polls the line once per PWM period. A shorter pulse can be missed there, but the driver has
/// then already switched itself off.
#[inline(always)]
pub fn driver_complains() -> bool {
    let (b, a) = FAULT_LINE;
    let is_low = GPIOB.idr().read().idr(b) == Idr::LOW || GPIOA.idr().read().idr(a) == Idr::LOW;
    if is_low || pwm::is_input_broken() {
        COMPLAINED.store(true, Relaxed);
    }
    COMPLAINED.load(Relaxed)
}

/// Clears the stored error of the driver. A line that is still low raises it again.
#[inline(always)]
pub fn forget_driver() {
    COMPLAINED.store(false, Relaxed);
}
