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

use embassy_stm32::adc::{Adc, AdcChannel};
use embassy_stm32::gpio::{AfType, Flex, Level, Output, OutputType, Pull, Speed};
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::pac::gpio::vals::Idr;
use embassy_stm32::pac::{GPIOA, GPIOB, GPIOC, TIM2};
use embassy_stm32::timer::complementary_pwm::ComplementaryPwmPin;
use embassy_stm32::timer::simple_pwm::PwmPin;
use embassy_stm32::usart::{self, BufferedUart};
use embassy_stm32::{Peripherals, bind_interrupts, peripherals};
use touchstone_drive::{EncoderReading, Hardware, hardware};

pub use crate::magnetic;
use crate::pwm::{BreakInput, Bridge, Complement};
use crate::sense::Readings;
use crate::storage::Storage;
use crate::{encoder, pwm, sense, serial};

/// Constants of the shield's power stage and sensors.
pub const HARDWARE: Hardware = hardware::IHM16M1;

bind_interrupts!(struct Irqs {
    LPUART1 => usart::BufferedInterruptHandler<peripherals::LPUART1>;
});

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

/// Pin number of the blue button, PC13: high while it is pressed (UM2505, "Push-buttons").
const STOP_BUTTON: usize = 13;

/// Sets up every pin and peripheral; the outputs stay off. The caller has yet to set the priority of the time driver's interrupt.
/// Returns the serial port to the computer and the flash of the settings.
pub fn set_up_pins(p: Peripherals) -> (BufferedUart<'static>, Storage) {
    interrupt::LPUART1.set_priority(Priority::P6);
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
    let mut stop_button = Flex::new(p.PC13);
    stop_button.set_as_input(Pull::Down);
    // Incremental encoder: both tracks have pull-ups, which open-collector encoders need.
    let mut tracks = (Flex::new(p.PA15), Flex::new(p.PB3));
    tracks.0.set_as_af_unchecked(1, AfType::input(Pull::Up));
    tracks.1.set_as_af_unchecked(1, AfType::input(Pull::Up));
    encoder::count_edges!(TIM2);
    // Encoder over SPI. The data line from the encoder has a pull-up, so a missing encoder reads as all ones. The parity of such a
    // frame is right, but its error bit is set, which causes fault 16.
    let mut lines = (Flex::new(p.PC10), Flex::new(p.PC11), Flex::new(p.PC12));
    lines
        .0
        .set_as_af_unchecked(6, AfType::output(OutputType::PushPull, Speed::High));
    lines.1.set_as_af_unchecked(6, AfType::input(Pull::Up));
    lines
        .2
        .set_as_af_unchecked(6, AfType::output(OutputType::PushPull, Speed::High));
    let select = Output::new(p.PD2, Level::High, Speed::High);
    magnetic::start(p.SPI3);
    // The pins stay as they are until the next reset.
    core::mem::forget((fault_line, limiter, stop_button, tracks, lines, select));
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
    let serial = BufferedUart::new(
        p.LPUART1,
        p.PA3,
        p.PA2,
        serial::SEND.take(),
        serial::RECEIVE.take(),
        Irqs,
        serial::config(),
    );
    (defmt::unwrap!(serial), Storage::new(p.FLASH))
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

/// Reads the counter of encoder edges in TIM2, which has 32 bits.
#[inline(always)]
pub fn encoder_count() -> EncoderReading {
    EncoderReading::Counter32(TIM2.cnt().read())
}

/// Whether the stop button is pressed. It is a convenience and no emergency stop: with a broken wire it does nothing.
#[inline(always)]
pub fn is_stop_pressed() -> bool {
    GPIOC.idr().read().idr(STOP_BUTTON) == Idr::HIGH
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
