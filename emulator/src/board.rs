//! The circuit board around the emulated chip: which pin measures which quantity, at which scale.

mod told;

use touchstone_control::Si;
use touchstone_protocol::settings::EncoderKind;

use crate::peripheral::encoder::{As5047p, Mt6701};
use crate::peripheral::spi::Slave;
use crate::peripheral::timer::gates::GateDriver;
use crate::world::{Parts, World};
pub use told::ToldMotor;

/// Reference voltage of the analog-to-digital converters, V.
pub const REFERENCE_V: f64 = 3.3;

/// Output code of an analog-to-digital converter for a voltage at its pin.
#[must_use]
pub fn code(volts: f64) -> u16 {
    code_with(volts, 0.0)
}

/// Same as `code`, for a voltage plus an error, which is in codes of the converter.
#[must_use]
pub fn code_with(volts: f64, error: f64) -> u16 {
    (volts / REFERENCE_V * 4_095.0 + error)
        .round()
        .clamp(0.0, 4_095.0) as u16
}

/// The position encoder that is mounted on the motor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Encoder {
    /// An incremental encoder with two tracks and this many counts per turn.
    Incremental(u32),
    /// The magnetic encoder AS5047P.
    As5047p,
    /// The magnetic encoder MT6701.
    Mt6701,
}

impl Encoder {
    /// The encoder's kind in the settings.
    #[must_use]
    pub fn kind(self) -> EncoderKind {
        match self {
            Self::Incremental(_) => EncoderKind::Incremental,
            Self::As5047p => EncoderKind::As5047p,
            Self::Mt6701 => EncoderKind::Mt6701,
        }
    }

    pub(crate) fn slave(self) -> Option<Box<dyn Slave>> {
        match self {
            Self::Incremental(_) => None,
            Self::As5047p => Some(Box::new(As5047p::default())),
            Self::Mt6701 => Some(Box::new(Mt6701::default())),
        }
    }
}

/// The quantity that a pin of an analog-to-digital converter measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// Current of a motor phase, numbered 0 to 2.
    Current(usize),
    /// Voltage of the supply bus.
    Bus,
    /// Temperature at the motor driver's thermistor.
    Temperature,
}

/// Injected faults at the chip's pins: wrong voltages, signals and encoder counts.
#[derive(Debug, Clone, Copy, Default)]
pub struct Wiring {
    /// Quantities whose pins carry a wrong voltage, each with that voltage in V.
    pub forced: [Option<(Source, f64)>; 2],
    /// Whether the gate driver pulls the break input, or its own fault line on boards that have such a line.
    pub break_pulled: bool,
    /// Mask of the chip's comparators (bit 0: COMP1) that a test makes report over-current, independently of their shunt.
    pub comparators: u32,
    /// Value at which the incremental encoder's count stays; `None` while the count follows the shaft.
    pub encoder_held: Option<i64>,
    /// Encoder counts that an injected fault adds to the count of the incremental encoder.
    pub encoder_moved: i64,
}

/// A circuit board with its motor and encoder.
#[derive(Debug, Clone)]
pub struct Board {
    /// Name of the board; the firmware's binary for it has the same name.
    pub name: &'static str,
    /// The encoder that is mounted.
    pub encoder: Encoder,
    /// Port and pin of the firmware's stop button. The pin is high while the button is pressed; otherwise the board pulls it down.
    pub button: Option<(usize, usize)>,
    /// Chip select of the magnetic encoder: port and pin.
    pub chip_select: Option<(usize, usize)>,
    /// Which serial port links the board to the computer. True: USART2. False: LPUART1.
    pub link_is_usart2: bool,
    /// Value of the option register FLASH_OPTR.
    pub option_bytes: u32,
    /// Value of the chip's identification register DBGMCU_IDCODE.
    pub device_id: u32,
    /// Size of the chip's flash memory, bytes.
    pub flash_bytes: usize,
    /// Size in bytes of the chip's contiguous memory: SRAM1, SRAM2, and the core-coupled memory (CCM) behind them, unless the
    /// program uses the CCM at its own address.
    pub ram_bytes: usize,
    /// Size in bytes of the core-coupled memory (CCM) at its own address; 0 where the program uses the CCM behind SRAM2. Use at two
    /// addresses at once is not modelled.
    pub ccm_bytes: usize,
    /// Measured quantities, each with its analog-to-digital converter (0 or 1) and the converter's channel.
    pub pins: &'static [(usize, u32, Source)],
    /// The gate drivers behind TIM1's outputs.
    pub gates: GateDriver,
    /// Output of a current sensor: voltage at no current in V, and volts per ampere into the motor. The second number is negative:
    /// the shunt is below the lower transistor, so a current into the motor comes from ground and pulls the shunt's upper end below
    /// ground.
    pub current: (f64, f64),
    /// Volts at the measuring pin per volt of the supply bus.
    pub bus_divider: f64,
    /// Port and pin of the line by which the motor driver reports a fault and is enabled. The line is open drain, and the board has
    /// no pull-up for it.
    pub driver_line: Option<(usize, usize)>,
    /// Phase current in A at which the drivers' own protection acts; infinite where there is no such protection.
    pub break_a: f64,
    /// Pins that measure the shunts before their amplifiers: port and pin, and the motor phase.
    pub shunts: &'static [((usize, usize), usize)],
    /// Voltage of the motor's supply, V.
    pub supply_v: f64,
    /// Dead time of one switching edge as a fraction (0 to 1) of the PWM period. During the dead time none of a phase's transistors
    /// conducts.
    pub dead_share: f64,
    /// Properties of the motor and the knob that are mounted.
    pub parts: Parts,
    /// Torque with which a hand presses in the tests on this board, N·m.
    pub press_n_m: f64,
    /// Torque with which a hand leans on the wall in a long test, N·m; too much for the motor to hold for ever.
    pub lean_n_m: f64,
    /// Largest speed of the rotating field in a calibration, electrical turns per second. In a faster field a small rotor would
    /// swing.
    pub field_turns_per_s: Si,
    /// Stiffnesses of the walls that the tests press, N·m/rad.
    pub walls: [Si; 2],
    /// The motor's values that a person has to enter where the board cannot measure them; `None` on other boards.
    pub told: Option<ToldMotor>,
    /// Injected faults of the wiring.
    pub wiring: Wiring,
}

/// On boards for larger motors: stiffnesses of the walls in N·m/rad, torque of a press and of a lasting press in N·m.
const THESIS: ([Si; 2], f64, f64) = ([Si::lit("1"), Si::lit("5")], 0.1, 0.45);

/// Port and pin of TIM1's break input, on boards whose motor driver has a fault line.
pub const BREAK_PIN: (usize, usize) = (1, 12);

/// The solder link on the shield X-NUCLEO-IHM16M1 that connects its line EN\FAULT to a pin. Shields differ in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FaultLink {
    /// Link R37: the line is at pin PB12.
    R37,
    /// Link R35: the line is at pin PA11.
    R35,
}

impl Board {
    /// All boards, with an AS5047P where a board can read one.
    #[must_use]
    pub fn all() -> [Self; touchstone_protocol::Board::ALL.len()] {
        let encoder = Encoder::As5047p;
        [
            Self::nucleo_g474re(encoder),
            Self::nucleo_g474re_ihm16m1(encoder, FaultLink::R37),
            Self::nucleo_g474re_simplefoc_mini(encoder),
            Self::nucleo_g431rb_ihm16m1(encoder, FaultLink::R37),
            Self::b_g431b_esc1(),
        ]
    }

    /// Whether a pin measures the motor driver's temperature.
    #[must_use]
    pub fn has_thermistor(&self) -> bool {
        self.pins.iter().any(|(.., at)| *at == Source::Temperature)
    }

    /// Whether a pin measures the current of a motor phase.
    #[must_use]
    pub fn measures_current(&self) -> bool {
        let mut sources = self.pins.iter().map(|(.., at)| at);
        sources.any(|at| matches!(at, Source::Current(_)))
    }

    /// Whether the motor is the kit's small gimbal motor with a light knob.
    #[must_use]
    pub fn has_small_motor(&self) -> bool {
        matches!(self.gates, GateDriver::Stspin830 | GateDriver::Drv8313)
    }

    /// Whether the board's firmware has environments of more than one wall.
    #[must_use]
    pub fn is_large(&self) -> bool {
        let named = touchstone_protocol::Board::ALL
            .into_iter()
            .find(|board| board.name() == self.name);
        named.is_some_and(touchstone_protocol::Board::is_large)
    }

    /// The board NUCLEO-G474RE with the shield X-NUCLEO-IHM08M1.
    #[must_use]
    pub fn nucleo_g474re(encoder: Encoder) -> Self {
        Self {
            name: "nucleo-g474re",
            encoder,
            // PC13 (UM2505).
            button: Some((2, 13)),
            // PD2.
            chip_select: Some((3, 2)),
            link_is_usart2: false,
            // Dual bank, read protection off.
            option_bytes: 0xffef_f8aa | 1 << 22,
            device_id: 0x2003_6469,
            flash_bytes: 512 * 1024,
            ram_bytes: 96 * 1024,
            ccm_bytes: 32 * 1024,
            pins: &[
                (0, 1, Source::Current(0)),
                (1, 7, Source::Current(1)),
                (0, 2, Source::Bus),
                (1, 8, Source::Temperature),
            ],
            gates: GateDriver::L6398,
            // The shunt is connected through 680 ohm and the 3.3 V through 6.8 kohm. An amplifier with the gain 1 + 4.7 kohm/1 kohm
            // follows.
            current: (REFERENCE_V * 0.68 / 7.48 * 5.7, -0.01 * 6.8 / 7.48 * 5.7),
            bus_divider: 9.31 / (169.0 + 9.31),
            driver_line: None,
            break_a: 20.0,
            shunts: &[],
            supply_v: 24.0,
            // The dead time is 0.5 µs at each edge; the PWM period is 50 µs.
            dead_share: 0.01,
            parts: Parts::default(),
            field_turns_per_s: Si::lit("16"),
            walls: THESIS.0,
            press_n_m: THESIS.1,
            lean_n_m: THESIS.2,
            told: None,
            wiring: Wiring::default(),
        }
    }

    /// NUCLEO-G474RE with X-NUCLEO-IHM16M1 and the motor of its kit, at 12 V. The values come from NuttX's page and an open test
    /// bench. The shield's schematic and the STSPIN830's data sheet were not read, so the current at which its own protection acts
    /// is an assumption.
    #[must_use]
    pub fn nucleo_g474re_ihm16m1(encoder: Encoder, link: FaultLink) -> Self {
        Self {
            name: "nucleo-g474re-ihm16m1",
            // ADC1_IN12 is PB1, ADC1_IN1 PA0, ADC2_IN2 PA1, ADC2_IN5 PC4.
            pins: &[
                (0, 12, Source::Current(1)),
                (0, 1, Source::Bus),
                (1, 2, Source::Current(0)),
                (1, 5, Source::Temperature),
            ],
            gates: GateDriver::Stspin830,
            // The shunt is connected through 680 ohm and the 3.3 V through 2.2 kohm. An amplifier with a gain of 2 follows.
            current: (REFERENCE_V * 0.68 / 2.88 * 2.0, -0.33 * 2.2 / 2.88 * 2.0),
            bus_divider: 1.0 / 16.0,
            driver_line: Some(match link {
                FaultLink::R37 => BREAK_PIN,
                FaultLink::R35 => (0, 11),
            }),
            break_a: 2.8,
            supply_v: 12.0,
            parts: Parts::gimbal_kit(),
            field_turns_per_s: Si::lit("4"),
            walls: [Si::lit("1"), Si::lit("2")],
            press_n_m: 0.03,
            lean_n_m: 0.06,
            // All other fields are those of the NUCLEO.
            ..Self::nucleo_g474re(encoder)
        }
    }

    /// NUCLEO-G431RB with X-NUCLEO-IHM16M1 and the motor of the kit P-NUCLEO-IHM03. Shield, connectors and button are those of the
    /// NUCLEO-G474RE (UM2505 describes both boards); the chip is smaller.
    #[must_use]
    pub fn nucleo_g431rb_ihm16m1(encoder: Encoder, link: FaultLink) -> Self {
        let same_chip = Self::b_g431b_esc1();
        Self {
            name: "nucleo-g431rb-ihm16m1",
            option_bytes: same_chip.option_bytes,
            device_id: same_chip.device_id,
            flash_bytes: same_chip.flash_bytes,
            ram_bytes: same_chip.ram_bytes,
            ccm_bytes: same_chip.ccm_bytes,
            // All other fields are those of the same shield on the other NUCLEO.
            ..Self::nucleo_g474re_ihm16m1(encoder, link)
        }
    }

    /// NUCLEO-G474RE with a SimpleFOC Mini on wires and the small gimbal motor, at 12 V. The values come from the Mini's schematic
    /// and from the DRV8313's data sheet (SLVSBA5D). Of the data sheet, the tables of operating conditions and inputs were read,
    /// the protections were not.
    #[must_use]
    pub fn nucleo_g474re_simplefoc_mini(encoder: Encoder) -> Self {
        Self {
            name: "nucleo-g474re-simplefoc-mini",
            // ADC1_IN1 is PA0.
            pins: &[(0, 1, Source::Bus)],
            gates: GateDriver::Drv8313,
            // The supply voltage is divided by 100 kohm above and 10 kohm below.
            bus_divider: 1.0 / 11.0,
            driver_line: Some(BREAK_PIN),
            // The smallest value of IOCP, the driver's over-current threshold, in the data sheet.
            break_a: 3.0,
            // The dead time is 90 ns in a PWM period of 50 µs.
            dead_share: 0.0018,
            parts: Parts::gimbal_on_mini(),
            told: Some(ToldMotor::GIMBAL),
            // All other fields are those of the board with the same motor.
            ..Self::nucleo_g474re_ihm16m1(encoder, FaultLink::R37)
        }
    }

    /// The board B-G431B-ESC1 with an incremental encoder.
    #[must_use]
    pub fn b_g431b_esc1() -> Self {
        Self {
            name: "b-g431b-esc1",
            encoder: Encoder::Incremental(16_384),
            button: None,
            chip_select: None,
            link_is_usart2: true,
            // One bank, read protection off.
            option_bytes: 0xffef_f8aa & !(1 << 22),
            device_id: 0x2003_6468,
            flash_bytes: 128 * 1024,
            ram_bytes: 32 * 1024,
            ccm_bytes: 0,
            // The three amplifier outputs are inside the chip. The other two inputs are PA0 and PB14.
            pins: &[
                (0, 13, Source::Current(0)),
                (1, 16, Source::Current(1)),
                (1, 18, Source::Current(2)),
                (0, 1, Source::Bus),
                (0, 5, Source::Temperature),
            ],
            gates: GateDriver::L6387,
            current: (16.0 * 0.9 / 7.0, -0.003 * 64.0 / 7.0),
            bus_divider: 1.0 / 10.39,
            driver_line: None,
            // The board has no over-current protection of its own besides the chip's comparators.
            break_a: f64::INFINITY,
            // The shunts of the phases are on PA1, PA7 and PB0.
            shunts: &[((0, 1), 0), ((0, 7), 1), ((1, 0), 2)],
            supply_v: 24.0,
            // The dead time is 0.5 µs at each edge; the PWM period is 50 µs.
            dead_share: 0.01,
            parts: Parts::default(),
            field_turns_per_s: Si::lit("16"),
            walls: THESIS.0,
            press_n_m: THESIS.1,
            lean_n_m: THESIS.2,
            told: None,
            wiring: Wiring::default(),
        }
    }

    /// Number, counted from 0, of the chip's amplifier whose output a converter's channel measures (RM0440, table of the
    /// converters' inputs); `None` for other channels. The output of an amplifier that is off floats; the model assumes 0 V.
    #[must_use]
    pub fn amplifier(&self, adc: usize, channel: u32) -> Option<usize> {
        match (adc, channel) {
            (0, 13) => Some(0),
            (1, 16) => Some(1),
            (1, 18) => Some(2),
            _ => None,
        }
    }

    /// Voltage in V at a pin of an analog-to-digital converter.
    #[must_use]
    pub fn analog(&self, adc: usize, channel: u32, world: &World) -> f64 {
        let Some((_, _, source)) = self
            .pins
            .iter()
            .find(|(at, pin, _)| (*at, *pin) == (adc, channel))
        else {
            return 0.0;
        };
        let forced = self
            .wiring
            .forced
            .iter()
            .flatten()
            .find(|(forced, _)| forced == source);
        if let Some((_, volts)) = forced {
            return *volts;
        }
        match source {
            Source::Current(phase) => self.current.0 + self.current.1 * world.leg_a(*phase),
            Source::Bus => world.bridge.bus_v * self.bus_divider,
            Source::Temperature => thermistor_v(world.temperature_c),
        }
    }

    /// Count of the incremental encoder for the shaft's angle, with the injected faults.
    #[must_use]
    pub fn encoder_count(&self, world: &World) -> i64 {
        let Encoder::Incremental(counts) = self.encoder else {
            return 0;
        };
        let count = (world.encoder_turns() * f64::from(counts)).floor() as i64;
        self.wiring.encoder_held.unwrap_or(count) + self.wiring.encoder_moved
    }

    /// Whether the motor driver pulls its fault line low, because its own protection acts or because a test injects the fault.
    #[must_use]
    pub fn driver_pulls(&mut self, world: &World) -> bool {
        let over = world.hardware_over_current();
        if self.gates == GateDriver::Drv8313 {
            // An over-current error stays until the supply is switched off, because the driver's reset line is not connected.
            self.wiring.break_pulled |= over;
            // The thermal shutdown threshold TTSD is at least 150 °C. This error ends when the driver has cooled down.
            return self.wiring.break_pulled || world.temperature_c >= 150.0;
        }
        self.wiring.break_pulled || over
    }

    /// Level of the timer's break pin; low is active.
    #[must_use]
    pub fn break_pin(&self, world: &World) -> bool {
        !(self.wiring.break_pulled || world.hardware_over_current())
    }

    /// Voltage at a pin of [`Board::shunts`] for a current through its shunt to ground, V. The shunt has 3 mOhm. From it, 1.5 kohm
    /// lead to the pin; from the pin, 22 kohm lead to 3.3 V and 2.2 kohm to ground.
    ///
    /// These resistors leave 4/7 of the shunt's voltage before an amplifier with a gain of 16, as in SimpleFOC's
    /// `LowsideCurrentSense(0.003f, -64.0f/7.0f, ...)` for this board (its example `B_G431B_ESC1.ino`). They are an assumption that
    /// gives this ratio; the schematic (MB1419) was not read.
    #[must_use]
    pub fn shunt_pin_v(&self, amps: f64) -> f64 {
        let (shunt, up, down) = (1.0 / 1.5e3, 1.0 / 22e3, 1.0 / 2.2e3);
        (0.003 * amps * shunt + REFERENCE_V * up) / (shunt + up + down)
    }

    /// The word at an address of the chip's read-only memory, which holds the flash size and the unique number.
    #[must_use]
    pub fn system_memory(&self, address: u32) -> u32 {
        match address {
            0x1fff_7590 => 0x0047_0031,
            0x1fff_7594 => 0x3133_5107,
            0x1fff_7598 => 0x2036_3935,
            // In KiB.
            0x1fff_75e0 => (self.flash_bytes / 1024) as u32,
            _ => 0xffff_ffff,
        }
    }

    /// The value that a register of an unmodelled block has after the program wrote `value`. Bits that report "ready" are set.
    #[must_use]
    pub fn read_back(&self, address: u32, value: u32) -> u32 {
        match address {
            // DAC_SR: both channels ready.
            0x5000_0834 => value | 1 << 11 | 1 << 27,
            _ => value,
        }
    }
}

/// Voltage of the shield's thermistor divider, V: 10 kohm at 25 degrees C with B = 3,455 K towards the supply, 4.7 kohm to ground.
fn thermistor_v(celsius: f64) -> f64 {
    let ohm = 10e3 * (3_455.0 * (1.0 / (celsius + 273.15) - 1.0 / 298.15)).exp();
    REFERENCE_V * 4.7e3 / (4.7e3 + ohm)
}
