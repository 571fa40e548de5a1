//! Registers that keep what is written and do nothing: SYSCFG, DBGMCU, COMP, OPAMP, DMA, VREFBUF and all that is not modelled.

use std::collections::BTreeMap;

use super::Peripheral;

/// A block of registers has 1 KiB.
const WORDS: usize = 256;

/// A block of plain registers.
#[derive(Debug, Clone)]
pub struct Plain {
    words: Box<[u32; WORDS]>,
    /// Registers of the processor and of blocks that are not modelled, whose addresses lie further apart.
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
    /// The value of a register.
    #[must_use]
    #[inline]
    pub fn get(&self, offset: u32) -> u32 {
        match self.words.get(offset as usize / 4) {
            Some(word) => *word,
            None => self.others.get(&offset).copied().unwrap_or(0),
        }
    }

    /// Sets a register.
    pub fn set(&mut self, offset: u32, value: u32) {
        match self.words.get_mut(offset as usize / 4) {
            Some(word) => *word = value,
            None => {
                self.others.insert(offset, value);
            }
        }
    }

    /// Starts with a value other than 0.
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
