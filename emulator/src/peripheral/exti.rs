//! The external interrupt controller EXTI, reduced to the detector of low supply: line 16 raises interrupt 1.

use super::Peripheral;
use super::plain::Plain;

const IMR1: u32 = 0x00;
const RTSR1: u32 = 0x08;
const FTSR1: u32 = 0x0c;
const SWIER1: u32 = 0x10;
const PR1: u32 = 0x14;
const PVD_LINE: u32 = 16;
const PVD_INTERRUPT: u32 = 1;

/// The external interrupt controller EXTI.
#[derive(Debug, Clone, Default)]
pub struct Exti {
    registers: Plain,
    pending: u32,
    detector: bool,
}

impl Exti {
    /// Sets the output of the detector of low supply: `low` while the supply is below the detector's threshold.
    pub fn set_detector(&mut self, low: bool) {
        let edges = if low { RTSR1 } else { FTSR1 };
        if low != self.detector && self.registers.get(edges) >> PVD_LINE & 1 != 0 {
            self.pending |= 1 << PVD_LINE;
        }
        self.detector = low;
    }
}

impl Peripheral for Exti {
    fn read(&mut self, offset: u32, now: u64) -> u32 {
        match offset {
            PR1 => self.pending,
            _ => self.registers.read(offset, now),
        }
    }

    fn write(&mut self, offset: u32, value: u32, now: u64) {
        match offset {
            PR1 => self.pending &= !value,
            SWIER1 => self.pending |= value,
            _ => self.registers.write(offset, value, now),
        }
    }

    fn lines(&self) -> u128 {
        let up = self.pending & self.registers.get(IMR1);
        u128::from(up >> PVD_LINE & 1) << PVD_INTERRUPT
    }
}
