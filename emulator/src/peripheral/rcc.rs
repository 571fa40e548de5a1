//! Clock control (RCC) and power control (PWR): ready bits that follow their enable bits after a delay, the clock tree up to
//! SYSCLK, and the cause of the last reset.

use std::collections::BTreeMap;

use super::{CYCLES_PER_US, NEVER, Peripheral};

/// A ready bit that follows an enable bit of the same register after a delay.
struct Ready {
    register: u32,
    on: u32,
    ready: u32,
    after_us: u64,
}

const fn ready(register: u32, on: u32, ready: u32, after_us: u64) -> Ready {
    Ready {
        register,
        on,
        ready,
        after_us,
    }
}

/// Enable and ready bits of the oscillators and the PLL (RM0440, 7.4). The delays are typical values of the data sheet DS12288.
const RCC: &[Ready] = &[
    ready(0x00, 8, 10, 2),
    ready(0x00, 16, 17, 2_000),
    ready(0x00, 24, 25, 40),
    ready(0x90, 0, 1, 10_000),
    ready(0x94, 0, 1, 80),
    ready(0x98, 0, 1, 3),
];

const CR: u32 = 0x00;
const CFGR: u32 = 0x08;
const PLLCFGR: u32 = 0x0c;
const CSR: u32 = 0x94;
const APB1ENR1: u32 = 0x58;
const RMVF: u32 = 1 << 23;
/// Mask of all reset flags in RCC_CSR.
const RESETS: u32 = 0xfe00_0000;

/// Cause of a reset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ResetCause {
    /// The power was switched on, or came back.
    PowerOn,
    /// The supply fell below the brown-out level.
    BrownOut,
    /// The reset pin NRST was pulled low.
    Pin,
    /// The program requested the reset through the bit SYSRESETREQ.
    Software,
    /// The independent watchdog reset the chip.
    Watchdog,
    /// The window watchdog reset the chip.
    WindowWatchdog,
}

impl ResetCause {
    /// Flags that this cause sets in RCC_CSR. Each includes the flag of the reset pin, because every reset pulls the pin low.
    fn flags(self) -> u32 {
        const PIN: u32 = 1 << 26;
        PIN | match self {
            Self::Pin => 0,
            Self::PowerOn | Self::BrownOut => 1 << 27,
            Self::Software => 1 << 28,
            Self::Watchdog => 1 << 29,
            Self::WindowWatchdog => 1 << 30,
        }
    }
}

/// The reset and clock control, RCC.
#[derive(Debug, Clone)]
pub struct Rcc {
    registers: BTreeMap<u32, u32>,
    /// Ready bits that will be set: (time in processor cycles, register, bit).
    coming: Vec<(u64, u32, u32)>,
    flags: u32,
}

impl Rcc {
    /// RCC after a reset. The reset flags of `before` stay set until the program clears them.
    #[must_use]
    pub fn new(cause: ResetCause, before: Option<&Self>) -> Self {
        let kept = match (cause, before) {
            (ResetCause::PowerOn | ResetCause::BrownOut, _) | (_, None) => 0,
            (_, Some(before)) => before.flags,
        };
        Self {
            // After a reset the oscillator HSI16 is on and is the system clock.
            registers: BTreeMap::from([
                (CR, 0x0000_0500),
                (CFGR, 0x0000_0005),
                (PLLCFGR, 0x0000_1000),
            ]),
            coming: Vec::new(),
            flags: kept | cause.flags(),
        }
    }

    fn get(&self, offset: u32) -> u32 {
        self.registers.get(&offset).copied().unwrap_or(0)
    }

    /// Whether a bit of an enable register is set: the peripheral then has its clock.
    #[must_use]
    pub fn gives(&self, register: u32, bit: u32) -> bool {
        self.get(register) >> bit & 1 != 0
    }

    /// Frequency of SYSCLK, Hz.
    #[must_use]
    pub fn sysclk_hz(&self) -> u64 {
        const HSI: u64 = 16_000_000;
        match self.get(CFGR) >> 2 & 3 {
            3 => {
                let pll = self.get(PLLCFGR);
                let m = u64::from(pll >> 4 & 15) + 1;
                let n = u64::from(pll >> 8 & 127);
                let r = 2 * (u64::from(pll >> 25 & 3) + 1);
                // The model assumes HSI16 as the PLL's source.
                // The crystal HSE (PLLSRC 3; 24 or 8 MHz on the boards) is not modelled.
                HSI * n / m / r
            }
            _ => HSI,
        }
    }
}

impl Rcc {
    /// Frequency of PCLK1 in hertz: SYSCLK divided by the prescalers HPRE and PPRE1.
    fn pclk1_hz(&self) -> u64 {
        let cfgr = self.get(CFGR);
        let hpre = match cfgr >> 4 & 15 {
            // The divisors are 2, 4, 8 and 16, then 64 to 512; there is no 32.
            code @ 8..=11 => code - 7,
            code @ 12..=15 => code - 6,
            _ => 0,
        };
        let ppre1 = match cfgr >> 8 & 7 {
            code @ 4..=7 => code - 3,
            _ => 0,
        };
        self.sysclk_hz() >> hpre >> ppre1
    }

    /// Clock frequency of the window watchdog's bus in hertz; 0 while that clock is switched off.
    #[must_use]
    pub fn wwdg_hz(&self) -> u64 {
        match self.get(APB1ENR1) >> 11 & 1 {
            0 => 0,
            _ => self.pclk1_hz(),
        }
    }
}

impl Peripheral for Rcc {
    fn read(&mut self, offset: u32, now: u64) -> u32 {
        self.advance(now);
        match offset {
            CSR => self.get(CSR) | self.flags,
            _ => self.get(offset),
        }
    }

    fn write(&mut self, offset: u32, value: u32, now: u64) {
        self.advance(now);
        let before = self.get(offset);
        let mut value = value;
        if offset == CSR && value & RMVF != 0 {
            self.flags = 0;
        }
        if offset == CSR {
            value &= !(RESETS | RMVF);
        }
        for rule in RCC.iter().filter(|rule| rule.register == offset) {
            let (on, ready) = (1 << rule.on, 1 << rule.ready);
            // The program cannot write the ready bit.
            value = (value & !ready) | (before & ready);
            if value & on == 0 {
                value &= !ready;
                self.coming
                    .retain(|(_, register, bit)| (*register, *bit) != (offset, ready));
            } else if before & on == 0 {
                self.coming
                    .push((now + rule.after_us * CYCLES_PER_US / 10, offset, ready));
            }
        }
        if offset == CFGR {
            // The clock switch is complete when SWS shows it, after a few cycles of the slower clock.
            value = (value & !0xc) | (before & 0xc);
            self.coming.retain(|(_, register, _)| *register != CFGR);
            self.coming.push((now + 20, CFGR, (value & 3) << 2));
        }
        self.registers.insert(offset, value);
    }

    fn next_event(&self) -> u64 {
        self.coming
            .iter()
            .map(|(time, ..)| *time)
            .min()
            .unwrap_or(NEVER)
    }

    fn advance(&mut self, now: u64) {
        if self.coming.iter().all(|(time, ..)| *time > now) {
            return;
        }
        for (_, register, bits) in self.coming.iter().filter(|(time, ..)| *time <= now) {
            let value = self.registers.entry(*register).or_default();
            let clear = if *register == CFGR { 0xc } else { 0 };
            super::change(value, *bits, clear);
        }
        self.coming.retain(|(time, ..)| *time > now);
    }
}

/// The power control, PWR: the ready flags of the voltage scaling, and the output of the voltage detector.
#[derive(Debug, Clone, Default)]
pub struct Pwr {
    registers: BTreeMap<u32, u32>,
    /// Supply voltage of the chip, V.
    pub supply_v: f64,
}

impl Pwr {
    /// Thresholds of the voltage detector in volts for a falling supply (DS12288).
    const LEVELS: [f64; 7] = [2.0, 2.2, 2.36, 2.47, 2.6, 2.73, 2.86];

    /// Power control of a chip with this supply voltage.
    #[must_use]
    pub fn new(supply_v: f64) -> Self {
        Self {
            registers: BTreeMap::from([(0x00, 0x0000_0200)]),
            supply_v,
        }
    }

    /// Output of the voltage detector: whether the supply is below the threshold that the program has set.
    #[must_use]
    pub fn is_low(&self) -> bool {
        let cr2 = self.registers.get(&0x04).copied().unwrap_or(0);
        let level = Self::LEVELS.get(cr2 as usize >> 1 & 7);
        cr2 & 1 != 0 && level.is_some_and(|level| self.supply_v < *level)
    }
}

impl Peripheral for Pwr {
    fn read(&mut self, offset: u32, _now: u64) -> u32 {
        match offset {
            // SR2: REGLPF and VOSF clear, flash ready; PVDO.
            0x14 => u32::from(self.is_low()) << 11,
            _ => self.registers.get(&offset).copied().unwrap_or(0),
        }
    }

    fn write(&mut self, offset: u32, value: u32, _now: u64) {
        self.registers.insert(offset, value);
    }
}
