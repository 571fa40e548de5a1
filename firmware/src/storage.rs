//! The 16 KiB of flash for the settings, accessed page by page.
//!
//! Writing stalls the processor, and an erase stalls it for some 22 ms. So the protocol session saves only while the outputs are
//! off (`touchstone_protocol::session`). The control interrupt does not run meanwhile, so no command can switch the outputs on.

use core::ops::Range;
use core::sync::atomic::{AtomicBool, Ordering::Relaxed};

use embassy_stm32::flash::{Blocking, Error, Flash};
use embassy_stm32::{Peri, peripherals};
use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

use crate::{watchdog, window};

/// Size of a flash page in bytes, the same on all supported chips.
pub const PAGE: usize = 2_048;

/// Address at which the flash begins.
pub const FLASH: u32 = 0x0800_0000;

unsafe extern "C" {
    static _settings_start: u8;
    static _settings_end: u8;
}

/// Where the settings' pages are, as offsets in bytes from the start of the flash. The board's memory map gives them.
pub fn pages() -> Range<u32> {
    let offset = |place: *const u8| place as u32 - FLASH;
    offset(&raw const _settings_start)..offset(&raw const _settings_end)
}

/// Whether settings are being read from flash. While true, an uncorrectable flash error (ECC) counts as an interrupted write of the
/// settings and does not stop the program.
pub static READING: AtomicBool = AtomicBool::new(false);

/// The flash pages in which the settings are stored; `None` if they cannot be used.
pub struct Storage(Option<Flash<'static, Blocking>>);

/// Why the flash of the settings cannot be accessed.
#[derive(Debug, Clone, Copy)]
pub enum StorageError {
    /// The chip's option bytes configure pages of another size than [`PAGE`].
    OtherPages,
    /// The flash reported an error.
    Refused(Error),
}

impl NorFlashError for StorageError {
    fn kind(&self) -> NorFlashErrorKind {
        match self {
            Self::OtherPages => NorFlashErrorKind::Other,
            Self::Refused(error) => NorFlashError::kind(error),
        }
    }
}

impl Storage {
    /// Takes the flash controller. A chip with two flash banks must be configured for two banks, its state on delivery. With one
    /// bank its pages are twice as large, and the settings are not stored.
    pub fn new(flash: Peri<'static, peripherals::FLASH>) -> Self {
        #[cfg(feature = "g474re")]
        if !embassy_stm32::pac::FLASH.optr().read().dbank() {
            defmt::error!("option byte DBANK is 0: settings cannot be kept");
            return Self(None);
        }
        Self(Some(Flash::new_blocking(flash)))
    }

    fn flash(&mut self) -> Result<&mut Flash<'static, Blocking>, StorageError> {
        self.0.as_mut().ok_or(StorageError::OtherPages)
    }
}

impl ErrorType for Storage {
    type Error = StorageError;
}

impl ReadNorFlash for Storage {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), StorageError> {
        let flash = self.flash()?;
        // A double word whose write was interrupted may have an uncorrectable error (ECC). It raises an interrupt, which is
        // harmless only here.
        READING.store(true, Relaxed);
        let read = flash.blocking_read(offset, bytes);
        READING.store(false, Relaxed);
        read.map_err(StorageError::Refused)
    }

    fn capacity(&self) -> usize {
        pages().end as usize
    }
}

impl NorFlash for Storage {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), StorageError> {
        for page in (from..to).step_by(PAGE) {
            // Nothing runs while the processor is stalled, not even the current loop.
            let flash = self.flash()?;
            window::extended(|| flash.blocking_erase(page, page + PAGE as u32))
                .map_err(StorageError::Refused)?;
            // The supervisor cannot run during this loop, whose length is bounded.
            watchdog::feed();
        }
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), StorageError> {
        self.flash()?
            .blocking_write(offset, bytes)
            .map_err(StorageError::Refused)
    }
}
