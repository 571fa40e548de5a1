//! What the program leaves in the registers after its start, against what the manuals say should stand there.
//!
//! The rows are a second witness for the wiring, written from the register descriptions and the pins' tables and not from the
//! firmware: an alternate function that is another timer's, a break with the wrong polarity, a filter of another length would make no
//! difference to the emulator's models, which do not look at them. Sections are those of RM0440, tables those of DS12288; both were
//! written down from memory of them and of the vendor's register description, **the pages were not opened**.

use super::tally::Tally;
use crate::bench::{Bench, MS, Setup};
use crate::cpu::elf::Program;

/// Bits that are looked at, what they should be, and why.
type Row = (u32, u32, u32, &'static str);

const TIM1: u32 = 0x4001_2c00;
const SYSCFG: u32 = 0x4001_0000;
const PWR: u32 = 0x4000_7000;
const EXTI: u32 = 0x4001_0400;
const RCC: u32 = 0x4002_1000;
const FLASH: u32 = 0x4002_2000;
const SPI3: u32 = 0x4000_3c00;
const GPIOA: u32 = 0x4800_0000;
const GPIOB: u32 = 0x4800_0400;

/// On both chips.
const ALL: &[Row] = &[
    (TIM1, 0xef, 0xa1, "TIM1_CR1: on, centre-aligned 1, preload"),
    (TIM1 + 0x04, 0xf0_0000, 7 << 20, "TIM1_CR2.MMS2: OC4REF"),
    (
        TIM1 + 0x0c,
        0xffff,
        1 << 7,
        "TIM1_DIER: the break's interrupt alone",
    ),
    (
        TIM1 + 0x18,
        0xffff,
        0x6868,
        "TIM1_CCMR1: PWM mode 1, preload, twice",
    ),
    (
        TIM1 + 0x1c,
        0xffff,
        0x7868,
        "TIM1_CCMR2: PWM mode 1 and 2, preload",
    ),
    (TIM1 + 0x28, 0xffff, 0, "TIM1_PSC: none"),
    (
        TIM1 + 0x2c,
        0xffff,
        4_250,
        "TIM1_ARR: 170 MHz / (2 · 20 kHz)",
    ),
    (TIM1 + 0x30, 0xffff, 0, "TIM1_RCR: an update at each end"),
    (
        TIM1 + 0x44,
        0xdf00,
        0x1e00,
        "TIM1_BDTR: lock level 2, OSSI, OSSR, break on, not by itself on again, off",
    ),
    (
        SYSCFG + 0x1c,
        0xf,
        0b1101,
        "SYSCFG_CFGR2: lockup, supply and ECC to the break; no parity",
    ),
    (
        PWR + 0x04,
        0xf,
        0b1101,
        "PWR_CR2: detector on, its highest level",
    ),
    (EXTI, 1 << 16, 1 << 16, "EXTI_IMR1: the detector's line"),
    (
        EXTI + 0x08,
        1 << 16,
        1 << 16,
        "EXTI_RTSR1: when the supply falls",
    ),
    (
        FLASH,
        0xf,
        4,
        "FLASH_ACR: four wait states for 170 MHz at 1.28 V (3.3.3)",
    ),
    (RCC + 0x08, 0xc, 0xc, "RCC_CFGR: the PLL is the clock"),
];

/// Alternate function of a pin: port, pin, number, what it is (DS12288, table 13).
type Function = (u32, u32, u32, &'static str);

const NUCLEO: &[Row] = &[
    (TIM1 + 0x20, 0x555, 0x555, "TIM1_CCER: all six outputs on"),
    (
        TIM1 + 0x20,
        0x888,
        0x888,
        "TIM1_CCER: low sides inverted, for the L6398",
    ),
    (
        TIM1 + 0x04,
        0x3f00,
        0x2a00,
        "TIM1_CR2: low sides' idle level high",
    ),
    (TIM1 + 0x44, 0xff, 85, "TIM1_BDTR.DTG: 500 ns of 5.88 ns"),
    (TIM1 + 0x44, 1 << 13, 0, "TIM1_BDTR.BKP: active low"),
    (
        TIM1 + 0x44,
        0xf_0000,
        3 << 16,
        "TIM1_BDTR.BKF: eight cycles",
    ),
    (
        TIM1 + 0x60,
        0x3ff,
        1,
        "TIM1_AF1: the pin BKIN alone, not inverted",
    ),
    (
        SPI3,
        0x3,
        1,
        "SPI3_CR1: idle low, the second edge (AS5047P: mode 1)",
    ),
    (SPI3, 0x7c, 0x64, "SPI3_CR1: master, on, a 32nd of 170 MHz"),
    (
        SPI3 + 0x04,
        0x1f00,
        0xf00,
        "SPI3_CR2: 16 bits, none of them early",
    ),
];

const NUCLEO_PINS: &[Function] = &[
    (0, 8, 6, "TIM1_CH1"),
    (0, 9, 6, "TIM1_CH2"),
    (0, 10, 6, "TIM1_CH3"),
    (0, 7, 6, "TIM1_CH1N"),
    (1, 0, 6, "TIM1_CH2N"),
    (1, 1, 6, "TIM1_CH3N"),
    (0, 6, 6, "TIM1_BKIN"),
    (0, 15, 1, "TIM2_CH1"),
    (1, 3, 1, "TIM2_CH2"),
    (2, 10, 6, "SPI3_SCK"),
    (2, 11, 6, "SPI3_MISO"),
    (2, 12, 6, "SPI3_MOSI"),
    (0, 2, 12, "LPUART1_TX"),
    (0, 3, 12, "LPUART1_RX"),
];

/// The X-NUCLEO-IHM16M1: the lower outputs are enables, held at their inactive level, which is high, while the main output is on.
const IHM16M1: &[Row] = &[
    (
        TIM1 + 0x20,
        0xfff,
        0x999,
        "TIM1_CCER: upper outputs on, lower ones off and inactive while high",
    ),
    (TIM1 + 0x04, 0x3f00, 0, "TIM1_CR2: idle levels low"),
    (TIM1 + 0x44, 0xff, 0, "TIM1_BDTR.DTG: none, the driver's own"),
    (TIM1 + 0x44, 1 << 13, 0, "TIM1_BDTR.BKP: active low"),
    (
        TIM1 + 0x44,
        0xf_0000,
        3 << 16,
        "TIM1_BDTR.BKF: eight cycles",
    ),
    (
        TIM1 + 0x60,
        0x3ff,
        1,
        "TIM1_AF1: the pin BKIN alone, not inverted",
    ),
    // Ports: 1 is an output, 0 an input; pulls: 1 is up.
    (GPIOA, 3 << 22, 0, "GPIOA_MODER: PA11 an input"),
    (GPIOA + 0x0c, 3 << 22, 1 << 22, "GPIOA_PUPDR: PA11 pulled up"),
    (GPIOB + 0x0c, 3 << 24, 1 << 24, "GPIOB_PUPDR: PB12 pulled up"),
    (GPIOB, 3 << 8, 1 << 8, "GPIOB_MODER: PB4 an output"),
    (GPIOB + 0x14, 1 << 4, 1 << 4, "GPIOB_ODR: PB4 high"),
];

const IHM16M1_PINS: &[Function] = &[
    (0, 8, 6, "TIM1_CH1"),
    (0, 9, 6, "TIM1_CH2"),
    (0, 10, 6, "TIM1_CH3"),
    (1, 13, 6, "TIM1_CH1N"),
    (1, 14, 6, "TIM1_CH2N"),
    (1, 15, 4, "TIM1_CH3N"),
    (1, 12, 6, "TIM1_BKIN"),
    (0, 15, 1, "TIM2_CH1"),
    (1, 3, 1, "TIM2_CH2"),
    (2, 10, 6, "SPI3_SCK"),
    (2, 11, 6, "SPI3_MISO"),
    (2, 12, 6, "SPI3_MOSI"),
    (0, 2, 12, "LPUART1_TX"),
    (0, 3, 12, "LPUART1_RX"),
];

const ESC1: &[Row] = &[
    (
        TIM1 + 0x20,
        0xfff,
        0x555,
        "TIM1_CCER: all six outputs on, none inverted, for the L6387",
    ),
    (TIM1 + 0x04, 0x3f00, 0, "TIM1_CR2: idle levels low"),
    (
        TIM1 + 0x44,
        0xff,
        0x84,
        "TIM1_BDTR.DTG: 800 ns in steps of two",
    ),
    (
        TIM1 + 0x44,
        1 << 13,
        1 << 13,
        "TIM1_BDTR.BKP: active high, for comparators",
    ),
    (
        TIM1 + 0x44,
        0xf_0000,
        15 << 16,
        "TIM1_BDTR.BKF: eight times 32 cycles",
    ),
    (
        TIM1 + 0x60,
        0x3ff,
        0b1_0110,
        "TIM1_AF1: COMP1, COMP2, COMP4, no pin",
    ),
    (SYSCFG + 0x200, 0x1, 1, "COMP1_CSR: on"),
    (SYSCFG + 0x204, 0x1, 1, "COMP2_CSR: on"),
    (SYSCFG + 0x20c, 0x1, 1, "COMP4_CSR: on"),
];

const ESC1_PINS: &[Function] = &[
    (0, 8, 6, "TIM1_CH1"),
    (0, 9, 6, "TIM1_CH2"),
    (0, 10, 6, "TIM1_CH3"),
    (2, 13, 4, "TIM1_CH1N"),
    (0, 12, 6, "TIM1_CH2N"),
    (1, 15, 4, "TIM1_CH3N"),
    (1, 6, 2, "TIM4_CH1"),
    (1, 7, 2, "TIM4_CH2"),
    (1, 3, 7, "USART2_TX"),
    (1, 4, 7, "USART2_RX"),
];

/// The check.
pub fn registers(program: &Program, setup: &Setup, tally: &mut Tally) {
    tally.check("registers after the start", compared(program, setup));
}

fn compared(program: &Program, setup: &Setup) -> Result<String, String> {
    let mut bench = Bench::new(program, setup)?;
    bench.boot()?;
    bench.run(20 * MS)?;
    let (rows, pins) = match setup.board.name {
        "nucleo-g474re" => (NUCLEO, NUCLEO_PINS),
        "nucleo-g474re-ihm16m1" => (IHM16M1, IHM16M1_PINS),
        _ => (ESC1, ESC1_PINS),
    };
    let chip = bench.machine.chip_mut();
    let mut wrong = Vec::new();
    for (address, bits, value, why) in ALL.iter().chain(rows) {
        let is = chip.read(*address, 4) & bits;
        if is != *value {
            wrong.push(format!("{why}: {is:#x} instead of {value:#x}"));
        }
    }
    for (port, pin, function, why) in pins {
        let base = 0x4800_0000 + 0x400 * port;
        let mode = chip.read(base, 4) >> (2 * pin) & 3;
        let is = chip.read(base + 0x20 + 4 * (pin / 8), 4) >> (4 * (pin % 8)) & 15;
        if (mode, is) != (2, *function) {
            wrong.push(format!(
                "{why} at P{}{pin}: mode {mode}, function {is} instead of {function}",
                ['A', 'B', 'C'][*port as usize]
            ));
        }
    }
    match wrong.as_slice() {
        [] => Ok(format!(
            "{} fields of registers and {} pins as the manuals want them",
            ALL.len() + rows.len(),
            pins.len()
        )),
        _ => Err(wrong.join("; ")),
    }
}
