//! B-G431B-ESC1: pins and peripherals.

use embassy_stm32::adc::{Adc, AdcChannel};
use embassy_stm32::gpio::OutputType;
use embassy_stm32::interrupt::{self, InterruptExt, Priority};
use embassy_stm32::timer::complementary_pwm::ComplementaryPwmPin;
use embassy_stm32::timer::simple_pwm::PwmPin;
use embassy_stm32::usart::{self, BufferedUart};
use embassy_stm32::{Peripherals, bind_interrupts, peripherals};

use crate::pwm::{BreakInput, Bridge};
use crate::run::Board;
use crate::{pwm, sense, serial};

/// As the host knows it.
pub const NAME: &str = "b-g431b-esc1";

bind_interrupts!(struct Irqs {
    USART2 => usart::BufferedInterruptHandler<peripherals::USART2>;
});

/// Gate drivers L6387 have no dead time of their own. The chip's comparators watch the shunts.
const BRIDGE: Bridge = Bridge {
    dead_time_ns: 800,
    break_input: BreakInput::Comparators(0b1011),
};

/// Sets up every pin and peripheral of the board; outputs stay off.
pub fn set_up(p: Peripherals) -> Board {
    interrupt::TIM3.set_priority(Priority::P6);
    interrupt::USART2.set_priority(Priority::P6);
    pwm::start(p.TIM1, BRIDGE);
    pwm::keep(
        (
            PwmPin::new(p.PA8, OutputType::PushPull),
            PwmPin::new(p.PA9, OutputType::PushPull),
            PwmPin::new(p.PA10, OutputType::PushPull),
        ),
        (
            ComplementaryPwmPin::new(p.PC13, OutputType::PushPull),
            ComplementaryPwmPin::new(p.PA12, OutputType::PushPull),
            ComplementaryPwmPin::new(p.PB15, OutputType::PushPull),
        ),
    );
    let serial = BufferedUart::new(
        p.USART2,
        p.PB4,
        p.PB3,
        serial::SEND.take(),
        serial::RECEIVE.take(),
        Irqs,
        serial::config(),
    );
    sense::start(
        Adc::new(p.ADC1, Default::default()),
        [
            (p.PA0.degrade_adc(), sense::FAST),
            (p.PA1.degrade_adc(), sense::SLOW),
            (p.PB14.degrade_adc(), sense::SLOW),
        ],
        Adc::new(p.ADC2, Default::default()),
        [
            (p.PA6.degrade_adc(), sense::FAST),
            (p.PA4.degrade_adc(), sense::SLOW),
            (p.PC4.degrade_adc(), sense::SLOW),
        ],
    );
    Board {
        serial: defmt::unwrap!(serial),
    }
}
