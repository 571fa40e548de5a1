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

use embassy_stm32::Peripherals;
use embassy_stm32::adc::{Adc, AdcChannel};
use embassy_stm32::gpio::{AfType, Flex, OutputType, Pull};
use embassy_stm32::interrupt::{self, InterruptExt, Priority};
use embassy_stm32::pac::GPIOB;
use embassy_stm32::pac::gpio::vals::Idr;
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

/// The board for which this program is built; the device reports it to the computer.
pub const BOARD: touchstone_protocol::Board = touchstone_protocol::Board::NucleoG474reSimplefocMini;

/// Constants of the power stage of the SimpleFOC Mini.
pub const HARDWARE: Hardware = hardware::SIMPLEFOC_MINI;

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

/// Sets up every pin and peripheral of the board; the outputs stay off. Returns the serial port to the computer and the settings'
/// flash.
pub fn set_up(p: Peripherals) -> (BufferedUart<'static>, Storage) {
    interrupt::TIM5.set_priority(Priority::P6);
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
    nucleo64::set_up_stop_button(p.PC13);
    nucleo64::set_up_tracks(p.PA15, p.PB3);
    nucleo64::set_up_spi(p.SPI3, p.PC10, p.PC11, p.PC12, p.PD2);
    // The pins stay as they are until the next reset.
    core::mem::forget(fault_line);
    // The board measures no current, only the supply voltage.
    sense::start_first(
        Adc::new(p.ADC1, Default::default()),
        [(p.PA0.degrade_adc(), sense::SLOW)],
    );
    let serial = nucleo64::serial_port(p.LPUART1, p.PA3, p.PA2);
    (serial, Storage::new(p.FLASH))
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
