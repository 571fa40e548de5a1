//! Registers that keep what is written and do nothing: SYSCFG, DBGMCU, COMP, OPAMP, DMA, VREFBUF and all that is not modelled.

use std::collections::BTreeMap;

use super::Peripheral;

/// A block of plain registers.
#[derive(Debug, Clone, Default)]
pub struct Plain {
    registers: BTreeMap<u32, u32>,
}

impl Plain {
    /// What a register holds.
    #[must_use]
    pub fn get(&self, offset: u32) -> u32 {
        self.registers.get(&offset).copied().unwrap_or(0)
    }

    /// Starts with a value other than 0.
    #[must_use]
    pub fn with(mut self, offset: u32, value: u32) -> Self {
        self.registers.insert(offset, value);
        self
    }
}

impl Peripheral for Plain {
    fn read(&mut self, offset: u32, _now: u64) -> u32 {
        self.get(offset)
    }

    fn write(&mut self, offset: u32, value: u32, _now: u64) {
        self.registers.insert(offset, value);
    }
}
