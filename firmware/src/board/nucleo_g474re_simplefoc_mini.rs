//! Pins and peripherals of the NUCLEO-G474RE with a SimpleFOC Mini v1.1 (DRV8313) on loose wires. **This board measures no
//! current.**
//!
//! | pins | source |
//! |---|---|
//! | the Mini's IN1, IN2, IN3, EN, nFT, 3V3 and both GND | its schematic v1.1 in its makers' repository |
//! | IN1 to PA8, IN2 to PA9, IN3 to PA10, EN to PB13, nFT to PB12 | our choice: TIM1's outputs, its first complementary output and its break, as with the X-NUCLEO-IHM16M1 |
//! | the supply through a divider of 100 kΩ over 10 kΩ to PA0 | our choice: the Mini does not measure the supply, so two resistors belong to the wiring |
//! | nSP and nRT stay open | 10 kΩ on the Mini pull them up, so the driver is neither asleep nor in reset |
//! | functions of the pins | as on the X-NUCLEO-IHM16M1 |
//!
//! PB14 and PB15 carry the same level as EN and are not wired. Nothing was measured on a board.

use core::sync::atomic::{AtomicBool, Ordering::Relaxed};

use embassy_stm32::adc::{Adc, AdcChannel};
use embassy_stm32::gpio::{AfType, Flex, Level, Output, OutputType, Pull, Speed};
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::pac::gpio::vals::Idr;
use embassy_stm32::pac::{GPIOB, GPIOC, TIM2};
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

/// The board for which this program is built; the device reports it to the computer.
pub const BOARD: touchstone_protocol::Board = touchstone_protocol::Board::NucleoG474reSimplefocMini;

/// Constants of the power stage of the SimpleFOC Mini.
pub const HARDWARE: Hardware = hardware::SIMPLEFOC_MINI;

bind_interrupts!(struct Irqs {
    LPUART1 => usart::BufferedInterruptHandler<peripherals::LPUART1>;
});

/// Settings of the PWM timer. The driver DRV8313 has an input for each phase and one enable for all, and adds its own dead time.
/// Its line nFAULT is the hardware break.
const BRIDGE: Bridge = Bridge {
    dead_time_ns: 0,
    complement: Complement::Enable,
    break_input: BreakInput::Pin,
};

/// Number of the alternate function TIM1_BKIN at pin PB12.
const BREAK_FUNCTION: u8 = 6;

/// Pin number of the line nFAULT, on port B.
const FAULT_LINE: usize = 12;

/// Pin number of the blue button, PC13: high while it is pressed (UM2505, "Push-buttons").
const STOP_BUTTON: usize = 13;

/// Sets up every pin and peripheral of the board; the outputs stay off. Returns the serial port to the computer and the settings'
/// flash.
pub fn set_up(p: Peripherals) -> (BufferedUart<'static>, Storage) {
    interrupt::TIM5.set_priority(Priority::P6);
    interrupt::LPUART1.set_priority(Priority::P6);
    // The line is open-drain; the Mini also has a pull-up resistor.
    let mut fault_line = Flex::new(p.PB12);
    fault_line.set_as_af_unchecked(BREAK_FUNCTION, AfType::input(Pull::Up));
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
    core::mem::forget((fault_line, stop_button, tracks, lines, select));
    // The board measures no current, only the supply voltage.
    sense::start_first(
        Adc::new(p.ADC1, Default::default()),
        [(p.PA0.degrade_adc(), sense::SLOW)],
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

/// Assigns the result of a finished conversion to the bus voltage. The board measures neither current nor temperature.
#[inline(always)]
pub fn readings() -> Readings {
    let [bus] = sense::take_first();
    Readings {
        phase_a: 0,
        phase_b: 0,
        bus,
        temperature: 0,
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

/// Whether the line nFAULT was low since [`forget_driver`].
static COMPLAINED: AtomicBool = AtomicBool::new(false);

/// Whether the driver has pulled its line nFAULT since [`forget_driver`]. Its causes are over-current, over-temperature and low
/// supply voltage; on this board no other sensor measures the first two. No pulse is missed, because the hardware break latches it.
#[inline(always)]
pub fn driver_complains() -> bool {
    if GPIOB.idr().read().idr(FAULT_LINE) == Idr::LOW || pwm::is_input_broken() {
        COMPLAINED.store(true, Relaxed);
    }
    COMPLAINED.load(Relaxed)
}

/// Clears the stored error of the driver. A line that is still low raises it again.
#[inline(always)]
pub fn forget_driver() {
    COMPLAINED.store(false, Relaxed);
}
