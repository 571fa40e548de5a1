//! Clocks and power: registers with ready bits that follow their enable bits after a while, the clock tree up to SYSCLK, and
//! why the chip was reset.

use std::collections::BTreeMap;

use super::{CYCLES_PER_US, NEVER, Peripheral};

/// A bit that follows another.
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

/// RM0440 7.4; times of the data sheet DS12288, typical.
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
/// All reset flags.
const RESETS: u32 = 0xfe00_0000;

/// Why the chip starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ResetCause {
    /// Power came on, or came back.
    PowerOn,
    /// The supply fell below the brown-out level.
    BrownOut,
    /// The pin NRST.
    Pin,
    /// SYSRESETREQ.
    Software,
    /// The independent watchdog.
    Watchdog,
    /// The window watchdog.
    WindowWatchdog,
}

impl ResetCause {
    /// The cause's flags in RCC_CSR: every reset pulls the pin as well.
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

/// RCC.
#[derive(Debug, Clone)]
pub struct Rcc {
    registers: BTreeMap<u32, u32>,
    /// The bits that will rise: (time, register, bit).
    coming: Vec<(u64, u32, u32)>,
    flags: u32,
}

impl Rcc {
    /// The state after a reset; flags of earlier resets stay until the program clears them.
    #[must_use]
    pub fn new(cause: ResetCause, before: Option<&Self>) -> Self {
        let kept = match (cause, before) {
            (ResetCause::PowerOn | ResetCause::BrownOut, _) | (_, None) => 0,
            (_, Some(before)) => before.flags,
        };
        Self {
            // HSI16 is on and the system's clock.
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

    /// Whether a bit of an enable register is set.
    #[must_use]
    pub fn gives(&self, register: u32, bit: u32) -> bool {
        self.get(register) >> bit & 1 != 0
    }

    /// SYSCLK, Hz.
    #[must_use]
    pub fn sysclk_hz(&self) -> u64 {
        const HSI: u64 = 16_000_000;
        match self.get(CFGR) >> 2 & 3 {
            3 => {
                let pll = self.get(PLLCFGR);
                let m = u64::from(pll >> 4 & 15) + 1;
                let n = u64::from(pll >> 8 & 127);
                let r = 2 * (u64::from(pll >> 25 & 3) + 1);
                // 3 is HSE, which no board here has but with 24 MHz or 8 MHz; not modelled apart.
                HSI * n / m / r
            }
            _ => HSI,
        }
    }
}

impl Rcc {
    /// PCLK1, Hz: SYSCLK through HPRE and PPRE1.
    fn pclk1_hz(&self) -> u64 {
        let cfgr = self.get(CFGR);
        let hpre = match cfgr >> 4 & 15 {
            // 2, 4, 8, 16, then without 32: 64 to 512.
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

    /// The window watchdog's clock, Hz; 0 if it is not switched on.
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
            // The switch is done when SWS says so: a few cycles of the slower clock.
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

/// PWR: the voltage scaling's ready flags and the voltage detector's output.
#[derive(Debug, Clone, Default)]
pub struct Pwr {
    registers: BTreeMap<u32, u32>,
    /// Supply of the chip, V.
    pub supply_v: f64,
}

impl Pwr {
    /// Levels of the detector, V, falling (DS12288).
    const LEVELS: [f64; 7] = [2.0, 2.2, 2.36, 2.47, 2.6, 2.73, 2.86];

    /// A unit at this supply voltage.
    #[must_use]
    pub fn new(supply_v: f64) -> Self {
        Self {
            registers: BTreeMap::from([(0x00, 0x0000_0200)]),
            supply_v,
        }
    }

    /// The detector's output: the supply is below its level.
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
