//! Pins and peripherals of the B-G431B-ESC1.
//!
//! Sources: UM2516 and the board's schematic, as the board files of NuttX and SimpleFOC quote them. Nothing was checked on a board.
//! The comparators' threshold is calculated from the schematic's values.

use embassy_stm32::adc::{Adc, AdcChannel};
use embassy_stm32::gpio::{AfType, Flex, OutputType, Pull};
use embassy_stm32::interrupt;
use embassy_stm32::interrupt::{InterruptExt, Priority};
use embassy_stm32::opamp::{OpAmp, OpAmpGain, OpAmpSpeed};
use embassy_stm32::pac::comp::vals::{Hysteresis, Inm};
use embassy_stm32::pac::dac::vals::Mode;
use embassy_stm32::pac::{COMP1, COMP2, COMP4, DAC3, OPAMP1, OPAMP2, OPAMP3, TIM4};
use embassy_stm32::timer::complementary_pwm::ComplementaryPwmPin;
use embassy_stm32::timer::simple_pwm::PwmPin;
use embassy_stm32::usart::{self, BufferedUart};
use embassy_stm32::{Peripherals, bind_interrupts, peripherals, rcc};
use static_cell::StaticCell;
use touchstone_drive::{EncoderReading, Hardware, hardware};

use crate::pwm::{BreakInput, Bridge, Complement};
use crate::sense::Readings;
use crate::storage::Storage;
use crate::{encoder, pwm, sense, serial_port};

/// The board for which this program is built; the device reports it to the computer.
pub const BOARD: touchstone_protocol::Board = touchstone_protocol::Board::BG431bEsc1;

/// Constants of the board's power stage and sensors.
pub const HARDWARE: Hardware = hardware::B_G431B_ESC1;

bind_interrupts!(struct Irqs {
    USART2 => usart::BufferedInterruptHandler<peripherals::USART2>;
});

/// Settings of the PWM timer. The gate drivers L6387 switch a transistor on while its input is high, and add no dead time of their
/// own. COMP1, COMP2 and COMP4 watch the three shunts.
const BRIDGE: Bridge = Bridge {
    dead_time_ns: 800,
    complement: Complement::ActiveHigh,
    break_input: BreakInput::Comparators(0b1011),
};

/// Threshold of the over-current comparators, as a code of 3.3 V / 4096: a current of 30 A out of the motor, through a lower
/// transistor.
///
/// The shunt's divider adds an offset of 0.129 V (160 codes) and leaves 4/7 of 3 mV/A (2.13 codes/A). The comparators see the
/// voltage before the amplifiers.
const BREAK_CODE: u16 = 160 + 64;

/// Sets up every pin and peripheral of the board; the outputs stay off. Returns the serial port to the computer and the settings'
/// flash.
pub fn set_up(p: Peripherals) -> (BufferedUart<'static>, Storage) {
    interrupt::TIM3.set_priority(Priority::P6);
    interrupt::USART2.set_priority(Priority::P6);
    // The amplifiers are configured until the next reset.
    static AMPLIFIER_1: StaticCell<OpAmp<'static, peripherals::OPAMP1>> = StaticCell::new();
    static AMPLIFIER_2: StaticCell<OpAmp<'static, peripherals::OPAMP2>> = StaticCell::new();
    static AMPLIFIER_3: StaticCell<OpAmp<'static, peripherals::OPAMP3>> = StaticCell::new();
    let amplifier_1 = AMPLIFIER_1.init(OpAmp::new(p.OPAMP1, OpAmpSpeed::HighSpeed));
    let amplifier_2 = AMPLIFIER_2.init(OpAmp::new(p.OPAMP2, OpAmpSpeed::HighSpeed));
    let amplifier_3 = AMPLIFIER_3.init(OpAmp::new(p.OPAMP3, OpAmpSpeed::HighSpeed));
    let phase_a = amplifier_1.pga_biased_int(p.PA1, p.PA3, OpAmpGain::Mul16);
    let phase_b = amplifier_2.pga_biased_int(p.PA7, p.PA5, OpAmpGain::Mul16);
    let phase_c = amplifier_3.pga_biased_int(p.PB0, p.PB2, OpAmpGain::Mul16);
    watch_shunts(p.DAC3);
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
    let mut tracks = (Flex::new(p.PB6), Flex::new(p.PB7));
    tracks.0.set_as_af_unchecked(2, AfType::input(Pull::Up));
    tracks.1.set_as_af_unchecked(2, AfType::input(Pull::Up));
    encoder::count_edges!(TIM4);
    core::mem::forget(tracks);
    sense::start(
        Adc::new(p.ADC1, Default::default()),
        [
            (phase_a.degrade_adc(), sense::AMPLIFIED),
            (p.PA0.degrade_adc(), sense::SLOW),
            (p.PB14.degrade_adc(), sense::SLOW),
        ],
        Adc::new(p.ADC2, Default::default()),
        // The third current and the divided phase voltage are not used. They are converted only so that both converters take the
        // same time.
        [
            (phase_b.degrade_adc(), sense::AMPLIFIED),
            (phase_c.degrade_adc(), sense::SLOW),
            (p.PC4.degrade_adc(), sense::SLOW),
        ],
    );
    // Handing an amplifier's output to a converter drops the amplifier, and the HAL then switches it off. So it is switched on
    // again here.
    for amplifier in [OPAMP1, OPAMP2, OPAMP3] {
        amplifier.csr().modify(|w| w.set_opampen(true));
    }
    let serial = BufferedUart::new(
        p.USART2,
        p.PB4,
        p.PB3,
        serial_port::SEND.take(),
        serial_port::RECEIVE.take(),
        Irqs,
        serial_port::config(),
    );
    (defmt::unwrap!(serial), Storage::new(p.FLASH))
}

/// Starts the comparators, with DAC3 as threshold: they detect over-current in hardware, without the processor.
///
/// On chips of revisions Z and Y the comparators were not fully tested in production (errata sheet ES0431 rev 7, 2.6.1). The current
/// loop checks the same currents in every PWM period (fault 1).
fn watch_shunts(_dac: embassy_stm32::Peri<'static, peripherals::DAC3>) {
    rcc::enable_and_reset::<peripherals::DAC3>();
    DAC3.mcr().write(|w| {
        w.set_hfsel(2);
        for channel in 0..2 {
            w.set_mode(channel, Mode::NORMAL_INT_BUFDIS);
        }
    });
    for channel in 0..2 {
        DAC3.dhr12r(channel).write(|w| w.set_dhr(BREAK_CODE));
    }
    DAC3.cr().write(|w| {
        w.set_en(0, true);
        w.set_en(1, true);
    });
    for comparator in [COMP1, COMP2, COMP4] {
        comparator.csr().write(|w| {
            // These comparators compare the shunt pins PA1, PA7 and PB0 with the voltages of DAC3.
            w.set_inpsel(false);
            w.set_inmsel(Inm::DACA);
            w.set_hyst(Hysteresis::HYST20M);
            w.set_en(true);
        });
    }
}

/// Assigns the results of a finished set of conversions to phases A and B, bus voltage and temperature. The third phase's current
/// is the negative sum of the two.
#[inline(always)]
pub fn readings() -> Readings {
    let raw = sense::take();
    let [phase_a, bus, temperature] = raw.first;
    let [phase_b, _, _] = raw.second;
    Readings {
        phase_a,
        phase_b,
        bus,
        temperature,
    }
}

/// Reads the counter of encoder edges in TIM4, which has 16 bits.
#[inline(always)]
pub fn encoder_count() -> EncoderReading {
    EncoderReading::Counter16(TIM4.cnt().read().cnt())
}

/// Empty functions in place of those for a magnetic encoder: this board has no port for one.
pub mod magnetic {
    use touchstone_drive::{EncoderKind, EncoderReading};

    /// An encoder reading in progress. The type has no values, since on this board no reading can be started.
    pub enum Last {}

    /// Does nothing: the board has no port to configure for a magnetic encoder.
    #[inline(always)]
    pub fn prepare(_kind: EncoderKind) {}

    /// Always `None`: no frame is sent to an encoder.
    #[inline(always)]
    pub fn begin(_kind: EncoderKind) -> Option<()> {
        None
    }

    /// Always `None`: no frame is sent to an encoder.
    #[inline(always)]
    pub fn go_on(_kind: EncoderKind) -> Option<Last> {
        None
    }

    /// Always returns the reading of an encoder that does not answer.
    #[inline(always)]
    pub fn end(_last: Option<Last>) -> EncoderReading {
        EncoderReading::Silent
    }
}

/// Always false. The board's button at PC10 is not used. Whether its pin is high or low while pressed is in the board's schematic,
/// which was not read.
#[inline(always)]
pub fn is_stop_pressed() -> bool {
    false
}

/// Always false: the board's gate drivers have no error output.
#[inline(always)]
pub fn driver_complains() -> bool {
    false
}

/// Does nothing: this board stores no error of its gate drivers.
#[inline(always)]
pub fn forget_driver() {}
