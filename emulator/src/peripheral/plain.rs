//! Registers that keep the written value and have no further effect: SYSCFG, DBGMCU, COMP, OPAMP, DMA, VREFBUF and all peripherals
//! that the emulator does not model.

use std::collections::BTreeMap;

use super::Peripheral;

/// Number of 32-bit registers in a block of 1 KiB.
const WORDS: usize = 256;

/// A block of registers that keep the written value.
#[derive(Debug, Clone)]
pub struct Plain {
    words: Box<[u32; WORDS]>,
    /// Values of registers at offsets outside the block of 1 KiB: those of the processor and of peripherals that are not modelled.
    others: BTreeMap<u32, u32>,
}

impl Default for Plain {
    fn default() -> Self {
        Self {
            words: Box::new([0; WORDS]),
            others: BTreeMap::new(),
        }
    }
}

impl Plain {
    /// Value of the register at `offset`.
    #[must_use]
    #[inline]
    pub fn get(&self, offset: u32) -> u32 {
        match self.words.get(offset as usize / 4) {
            Some(word) => *word,
            None => self.others.get(&offset).copied().unwrap_or(0),
        }
    }

    /// Sets the register at `offset`.
    pub fn set(&mut self, offset: u32, value: u32) {
        match self.words.get_mut(offset as usize / 4) {
            Some(word) => *word = value,
            None => {
                self.others.insert(offset, value);
            }
        }
    }

    /// Sets the value after reset of the register at `offset`, for a register whose value is not 0.
    #[must_use]
    pub fn with(mut self, offset: u32, value: u32) -> Self {
        self.set(offset, value);
        self
    }
}

impl Peripheral for Plain {
    fn read(&mut self, offset: u32, _now: u64) -> u32 {
        self.get(offset)
    }

    fn write(&mut self, offset: u32, value: u32, _now: u64) {
        self.set(offset, value);
    }
}
