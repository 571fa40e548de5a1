//! The image of the settings in flash. Each flash page is a slot for one image, and the slots are written in turn. So a power
//! failure at any write or erase loses only the image that was being written.
//!
//! ```text
//! page:  sequence u32 | length u32 | image (stored.rs) | CRC-32 of all before | erased
//! ```
//!
//! The device uses the newest complete slot. A write erases and fills the next slot, which is the oldest. A power failure damages
//! that page only: the newest slot is not touched until another slot is complete. No state outside the slots needs repair.
//!
//! The crate sequential-storage is not used: its pages have a state in a byte at each end, and an interrupted erase leaves any
//! pattern of bits. In a simulation of power failures (`tests/src/flash.rs`), some 2 of 100 failures during an erase lost all
//! settings.
//!
//! If the power fails while an STM32G4 programs a double word, reading that double word later may give an ECC error. The read then
//! raises the NMI, whose handler has to clear the flag and return. The slot's CRC then rejects the data that were read.

use crate::frame::crc_of;
use crate::session::FlashError;
use crate::settings::DeviceSettings;
use crate::stored::{self, Check, IMAGE_MAX, Refused, Start};
use core::ops::Range;
use embedded_storage::nor_flash::NorFlash;

const HEADER: usize = 8;
const CRC_BYTES: usize = 4;
/// Largest size of a slot (header, image of the settings, CRC) in bytes, rounded up to a multiple of 16, so that it fits the write
/// units of any flash.
const SLOT_MAX: usize = (HEADER + IMAGE_MAX + CRC_BYTES).next_multiple_of(16);

/// The content of a complete slot: its place in the sequence of writes, and the image of the settings.
struct Slot<'b> {
    sequence: u32,
    image: &'b [u8],
}

/// The content of a flash page, which is the slot for one image of the settings.
enum Page<'b> {
    Erased,
    Damaged,
    Whole(Slot<'b>),
}

/// Reads the settings with which the device starts: the newest stored ones of a readable layout, or `defaults` if nothing was
/// ever stored. If the newest ones are not valid, or none of the stored data has a readable layout, returns the defaults with the
/// reason.
pub fn load<F: NorFlash>(
    flash: &mut F,
    pages: Range<u32>,
    defaults: DeviceSettings,
    check: Check<'_>,
) -> Start {
    let mut buffer = [0; SLOT_MAX];
    let mut newest: Option<(u32, u32)> = None;
    let mut refused = None;
    for page in addresses::<F>(&pages) {
        match read(flash, page, &mut buffer) {
            Page::Erased => {}
            Page::Damaged => refused = refused.or(Some(Refused::Damaged)),
            Page::Whole(slot) => match stored::layout_version(slot.image) {
                Some(version) if stored::is_readable(version) => {
                    if newest.is_none_or(|(sequence, _)| slot.sequence > sequence) {
                        newest = Some((slot.sequence, page));
                    }
                }
                Some(version) => refused = Some(Refused::OtherLayout(version)),
                None => refused = refused.or(Some(Refused::Damaged)),
            },
        }
    }
    if let Some((_, page)) = newest
        && let Page::Whole(slot) = read(flash, page, &mut buffer)
    {
        return stored::start(Some(slot.image), defaults, check);
    }
    Start::defaults(defaults, refused)
}

/// Writes an image of the settings into the next slot and reads it back to compare.
///
/// # Errors
/// The image is too long for a slot, the flash reported an error, or the data read back differ. The settings stored before are
/// still readable.
pub fn save<F: NorFlash>(flash: &mut F, pages: Range<u32>, image: &[u8]) -> Result<(), FlashError> {
    let mut buffer = [0xff; SLOT_MAX];
    let mut newest: Option<(u32, u32)> = None;
    for page in addresses::<F>(&pages) {
        if let Page::Whole(slot) = read(flash, page, &mut buffer)
            && newest.is_none_or(|(sequence, _)| slot.sequence > sequence)
        {
            newest = Some((slot.sequence, page));
        }
    }
    let size = u32::try_from(F::ERASE_SIZE).map_err(|_| FlashError)?;
    let (sequence, page) = match newest {
        None => (0, pages.start),
        Some((sequence, page)) => {
            let next = page.saturating_add(size);
            let turn = next.saturating_add(size) > pages.end;
            (
                sequence.saturating_add(1),
                if turn { pages.start } else { next },
            )
        }
    };
    let slot = write_slot(&mut buffer, sequence, image).ok_or(FlashError)?;
    let length = slot.len().next_multiple_of(F::WRITE_SIZE);
    let words = buffer.get(..length).ok_or(FlashError)?;
    flash
        .erase(page, page.saturating_add(size))
        .map_err(|_| FlashError)?;
    flash.write(page, words).map_err(|_| FlashError)?;
    match read(flash, page, &mut buffer) {
        Page::Whole(slot) if slot.sequence == sequence && slot.image == image => Ok(()),
        _ => Err(FlashError),
    }
}

/// Fills `buffer` with a slot (header, image, CRC) and the rest with 0xFF, the erased state. Returns the slot's bytes.
fn write_slot<'b>(buffer: &'b mut [u8; SLOT_MAX], sequence: u32, image: &[u8]) -> Option<&'b [u8]> {
    buffer.fill(0xff);
    let length = u32::try_from(image.len()).ok()?;
    let content = HEADER.checked_add(image.len())?;
    buffer
        .get_mut(..4)?
        .copy_from_slice(&sequence.to_le_bytes());
    buffer
        .get_mut(4..HEADER)?
        .copy_from_slice(&length.to_le_bytes());
    buffer.get_mut(HEADER..content)?.copy_from_slice(image);
    let sum = crc_of(buffer.get(..content)?);
    let end = content.checked_add(CRC_BYTES)?;
    buffer
        .get_mut(content..end)?
        .copy_from_slice(&sum.to_le_bytes());
    buffer.get(..end)
}

/// Start addresses of the flash pages.
fn addresses<F: NorFlash>(pages: &Range<u32>) -> impl Iterator<Item = u32> {
    pages.clone().step_by(F::ERASE_SIZE)
}

/// Reads the slot of a page. A page that cannot be read counts as damaged.
fn read<'b, F: NorFlash>(flash: &mut F, page: u32, buffer: &'b mut [u8; SLOT_MAX]) -> Page<'b> {
    if flash.read(page, buffer).is_err() {
        return Page::Damaged;
    }
    if buffer.iter().all(|&byte| byte == 0xff) {
        return Page::Erased;
    }
    slot(buffer).map_or(Page::Damaged, Page::Whole)
}

fn slot(buffer: &[u8]) -> Option<Slot<'_>> {
    let (sequence, rest) = buffer.split_first_chunk::<4>()?;
    let (length, _) = rest.split_first_chunk::<4>()?;
    let length = usize::try_from(u32::from_le_bytes(*length)).ok()?;
    let content = HEADER.checked_add(length)?;
    let sum = buffer.get(content..)?.first_chunk::<CRC_BYTES>()?;
    if crc_of(buffer.get(..content)?).to_le_bytes() != *sum {
        return None;
    }
    Some(Slot {
        sequence: u32::from_le_bytes(*sequence),
        image: buffer.get(HEADER..content)?,
    })
}
