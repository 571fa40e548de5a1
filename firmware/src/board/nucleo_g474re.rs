//! Pins and peripherals of the NUCLEO-G474RE with the three-phase shield X-NUCLEO-IHM08M1.
//!
//! Sources: UM2505 (the board); UM1996 (the shield) and its schematic, as the open projects NuttX and oxifoc quote them; the chip's
//! data sheet DS12288 (functions of the pins). Nothing was checked on a board. The shield connects PB15 with PA7 and PB14 with PA6,
//! so PB15 and PB14 stay undriven, as after a reset.

use embassy_stm32::Peripherals;
use embassy_stm32::adc::{Adc, AdcChannel};
use embassy_stm32::gpio::{AfType, Flex, Level, Output, OutputType, Pull, Speed};
use embassy_stm32::interrupt::{self, InterruptExt, Priority};
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
use crate::{analogue, pwm, sense};

/// The board for which this program is built; the device reports it to the computer.
pub const BOARD: touchstone_protocol::Board = touchstone_protocol::Board::NucleoG474re;

/// Constants of the shield's power stage and sensors.
pub const HARDWARE: Hardware = hardware::IHM08M1;

/// Settings of the PWM timer. The gate drivers L6398 switch a lower transistor on while its input LIN is low, and add a dead time
/// of 320 ns themselves. The shield's over-current comparators are wired to the pin BKIN.
const BRIDGE: Bridge = Bridge {
    dead_time_ns: 500,
    complement: Complement::ActiveLow,
    break_input: BreakInput::Pin,
};

/// Number of the alternate function TIM1_BKIN at pin PA6.
const BREAK_FUNCTION: u8 = 6;

/// Pin number of PC8, on the morpho connector: it enables an external servo amplifier while it is high.
const AMPLIFIER: u8 = 8;

/// Sets up every pin and peripheral of the board; the outputs stay off. Returns the serial port to the computer and the settings'
/// flash.
pub fn set_up(p: Peripherals) -> (BufferedUart<'static>, Storage) {
    interrupt::TIM5.set_priority(Priority::P6);
    let mut break_pin = Flex::new(p.PA6);
    break_pin.set_as_af_unchecked(BREAK_FUNCTION, AfType::input(Pull::Up));
    pwm::start(p.TIM1, BRIDGE);
    pwm::keep(
        (
            PwmPin::new(p.PA8, OutputType::PushPull),
            PwmPin::new(p.PA9, OutputType::PushPull),
            PwmPin::new(p.PA10, OutputType::PushPull),
        ),
        (
            ComplementaryPwmPin::new(p.PA7, OutputType::PushPull),
            ComplementaryPwmPin::new(p.PB0, OutputType::PushPull),
            ComplementaryPwmPin::new(p.PB1, OutputType::PushPull),
        ),
    );
    let amplifier = Output::new(p.PC8, Level::Low, Speed::Low);
    analogue::start(p.DAC1, AMPLIFIER);
    nucleo64::set_up_stop_button(p.PC13);
    nucleo64::set_up_tracks(p.PA15, p.PB3);
    nucleo64::set_up_spi(p.SPI3, p.PC10, p.PC11, p.PC12, p.PD2);
    // The pins stay as they are until the next reset.
    core::mem::forget((break_pin, amplifier));
    sense::start(
        Adc::new(p.ADC1, Default::default()),
        [
            (p.PA0.degrade_adc(), sense::FAST),
            (p.PA1.degrade_adc(), sense::SLOW),
        ],
        Adc::new(p.ADC2, Default::default()),
        [
            (p.PC1.degrade_adc(), sense::FAST),
            (p.PC2.degrade_adc(), sense::SLOW),
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
    let [phase_a, bus] = raw.first;
    let [phase_b, temperature] = raw.second;
    Readings {
        phase_a,
        phase_b,
        bus,
        temperature,
    }
}

/// Always false: the shield's gate drivers have no error output. Its comparators act on the hardware break.
#[inline(always)]
pub fn driver_complains() -> bool {
    false
}

/// Does nothing: this board stores no error of its gate drivers.
#[inline(always)]
pub fn forget_driver() {}
