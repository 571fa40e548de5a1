//! NUCLEO-G474RE with the three-phase shield X-NUCLEO-IHM08M1: pins and peripherals.

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
pub const NAME: &str = "nucleo-g474re";

bind_interrupts!(struct Irqs {
    LPUART1 => usart::BufferedInterruptHandler<peripherals::LPUART1>;
});

/// Gate drivers L6398: their own dead time is 320 ns at most, and the pin BKIN is their comparators' output.
const BRIDGE: Bridge = Bridge {
    dead_time_ns: 500,
    break_input: BreakInput::Pin,
};

/// Sets up every pin and peripheral of the board; outputs stay off.
pub fn set_up(p: Peripherals) -> Board {
    interrupt::TIM5.set_priority(Priority::P6);
    interrupt::LPUART1.set_priority(Priority::P6);
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
    let serial = BufferedUart::new(
        p.LPUART1,
        p.PA3,
        p.PA2,
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
            (p.PC1.degrade_adc(), sense::FAST),
            (p.PC2.degrade_adc(), sense::SLOW),
            (p.PC3.degrade_adc(), sense::SLOW),
        ],
    );
    Board {
        serial: defmt::unwrap!(serial),
    }
}
