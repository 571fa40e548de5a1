//! A simulated flash memory like a microcontroller's. Its words of 8 bytes can be programmed once after an erase of their 2 KiB
//! page. Its power can fail at any moment.

use crate::random::Random;
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

const WORD: usize = 8;
const PAGE: usize = 2048;

/// The simulated flash memory.
#[derive(Debug, Clone)]
pub struct Flash {
    bytes: Vec<u8>,
    random: Random,
    /// Number of operations (programming a word or erasing a page) until the power fails in the middle of one; `None` for steady
    /// power.
    left: Option<usize>,
    /// Number of words programmed and pages erased so far.
    pub operations: usize,
}

/// Why the flash refused an operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FlashFault {
    /// The power has failed.
    PowerGone,
    /// The word was not erased before, or the address does not begin a word or a page.
    Wrong,
}

impl NorFlashError for FlashFault {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::Other
    }
}

impl Flash {
    /// Creates a flash memory of this many erased pages.
    #[must_use]
    pub fn erased(pages: usize) -> Self {
        Self {
            bytes: vec![0xff; pages * PAGE],
            random: Random::new(7),
            left: None,
            operations: 0,
        }
    }

    /// Address range of all pages of the flash.
    #[must_use]
    pub fn range(&self) -> core::ops::Range<u32> {
        0..self.bytes.len() as u32
    }

    /// Makes the power fail in the middle of an operation, after this many complete ones. The seed decides which bits of the
    /// unfinished operation change.
    pub fn cut_after(&mut self, operations: usize, seed: u64) {
        self.left = Some(operations);
        self.random = Random::new(seed);
    }

    /// Restores the power of the flash.
    pub fn power_on(&mut self) {
        self.left = None;
    }

    /// Overwrites the whole flash memory with this byte.
    pub fn fill(&mut self, byte: u8) {
        self.bytes.fill(byte);
    }

    /// Begins an operation (programming a word or erasing a page). Returns whether the power fails during it; an error if it failed
    /// before.
    fn begin(&mut self) -> Result<bool, FlashFault> {
        self.operations += 1;
        match &mut self.left {
            None => Ok(false),
            Some(0) => {
                // Nothing after this operation succeeds either.
                self.left = Some(usize::MAX);
                Ok(true)
            }
            Some(usize::MAX) => Err(FlashFault::PowerGone),
            Some(left) => {
                *left -= 1;
                Ok(false)
            }
        }
    }
}

impl ErrorType for Flash {
    type Error = FlashFault;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;
    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), FlashFault> {
        let from = offset as usize;
        let there = self
            .bytes
            .get(from..from + bytes.len())
            .ok_or(FlashFault::Wrong)?;
        bytes.copy_from_slice(there);
        Ok(())
    }
    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = WORD;
    const ERASE_SIZE: usize = PAGE;

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), FlashFault> {
        if !(offset as usize).is_multiple_of(WORD) || !bytes.len().is_multiple_of(WORD) {
            return Err(FlashFault::Wrong);
        }
        for (index, word) in bytes.chunks(WORD).enumerate() {
            let cut = self.begin()?;
            let place = offset as usize + index * WORD;
            // If the power fails while a word is programmed, random bits of it are programmed.
            let not_yet = if cut { self.random.bits() } else { 0 };
            let there = self
                .bytes
                .get_mut(place..place + WORD)
                .ok_or(FlashFault::Wrong)?;
            // Because of the check code beside each word, a word cannot be programmed twice, except to all zeros.
            if there.iter().any(|&byte| byte != 0xff) && word.iter().any(|&byte| byte != 0) {
                return Err(FlashFault::Wrong);
            }
            for ((there, byte), not_yet) in there.iter_mut().zip(word).zip(not_yet.to_le_bytes()) {
                *there &= byte | not_yet;
            }
            if cut {
                return Err(FlashFault::PowerGone);
            }
        }
        Ok(())
    }

    fn erase(&mut self, from: u32, to: u32) -> Result<(), FlashFault> {
        let (from, to) = (from as usize, to as usize);
        if !from.is_multiple_of(PAGE) || !to.is_multiple_of(PAGE) || to > self.bytes.len() {
            return Err(FlashFault::Wrong);
        }
        for page in (from..to).step_by(PAGE) {
            let cut = self.begin()?;
            for byte in &mut self.bytes[page..page + PAGE] {
                // If the power fails during an erase, random bits are back at one.
                *byte |= if cut { self.random.bits() as u8 } else { 0xff };
            }
            if cut {
                return Err(FlashFault::PowerGone);
            }
        }
        Ok(())
    }
}
