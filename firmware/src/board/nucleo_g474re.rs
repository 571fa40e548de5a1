//! Pins and peripherals of the NUCLEO-G474RE with the three-phase shield X-NUCLEO-IHM08M1.
//!
//! Sources: UM2505 (the board); UM1996 (the shield) and its schematic, as the open projects NuttX and oxifoc quote them; the chip's
//! data sheet DS12288 (functions of the pins). Nothing was checked on a board. The shield connects PB15 with PA7 and PB14 with PA6,
//! so PB15 and PB14 stay undriven, as after a reset.

use embassy_stm32::adc::{Adc, AdcChannel};
use embassy_stm32::gpio::{AfType, Flex, Level, Output, OutputType, Pull, Speed};
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::pac::gpio::vals::Idr;
use embassy_stm32::pac::{GPIOC, TIM2};
use embassy_stm32::timer::complementary_pwm::ComplementaryPwmPin;
use embassy_stm32::timer::simple_pwm::PwmPin;
use embassy_stm32::usart::{self, BufferedUart};
use embassy_stm32::{Peripherals, bind_interrupts, peripherals};
use touchstone_drive::{EncoderReading, Hardware, hardware};

pub use crate::magnetic;
use crate::pwm::{BreakInput, Bridge, Complement};
use crate::sense::Readings;
use crate::storage::Storage;
use crate::{analogue, encoder, pwm, sense, serial};

/// The board for which this program is built; the device reports it to the computer.
pub const BOARD: touchstone_protocol::Board = touchstone_protocol::Board::NucleoG474re;

/// Constants of the shield's power stage and sensors.
pub const HARDWARE: Hardware = hardware::IHM08M1;

bind_interrupts!(struct Irqs {
    LPUART1 => usart::BufferedInterruptHandler<peripherals::LPUART1>;
});

/// Settings of the PWM timer. The gate drivers L6398 switch a lower transistor on while its input LIN is low, and add a dead time
/// of 320 ns themselves. The shield's over-current comparators are wired to the pin BKIN.
const BRIDGE: Bridge = Bridge {
    dead_time_ns: 500,
    complement: Complement::ActiveLow,
    break_input: BreakInput::Pin,
};

/// Number of the alternate function TIM1_BKIN at pin PA6.
const BREAK_FUNCTION: u8 = 6;

/// Pin number of the blue button, PC13: high while it is pressed (UM2505, "Push-buttons").
const STOP_BUTTON: usize = 13;

/// Pin number of PC8, on the morpho connector: it enables an external servo amplifier while it is high.
const AMPLIFIER: u8 = 8;

/// Sets up every pin and peripheral of the board; the outputs stay off. Returns the serial port to the computer and the settings'
/// flash.
pub fn set_up(p: Peripherals) -> (BufferedUart<'static>, Storage) {
    interrupt::TIM5.set_priority(Priority::P6);
    interrupt::LPUART1.set_priority(Priority::P6);
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
    core::mem::forget((break_pin, amplifier, stop_button, tracks, lines, select));
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
    let [phase_a, bus] = raw.first;
    let [phase_b, temperature] = raw.second;
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

/// Always false: the shield's gate drivers have no error output. Its comparators act on the hardware break.
#[inline(always)]
pub fn driver_complains() -> bool {
    false
}

/// Does nothing: this board stores no error of its gate drivers.
#[inline(always)]
pub fn forget_driver() {}
