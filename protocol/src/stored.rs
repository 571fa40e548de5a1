//! The settings as an image in flash: layout version, content, CRC.
//!
//! ```text
//! layout version u16 | postcard of DeviceSettings | CRC-32 of all before
//! layout version u16 | postcard of DeviceSettings, Surround, KeptStart and the cogging map, if one is stored | CRC-32 of all before
//! ```
//!
//! Boards with room for an environment (more walls, end stops, detents) write the second form. They also read the first. Its
//! missing parts get their defaults: the settings' wall alone, no data for the start, no cogging map.
//!
//! `flash.rs` decides where the image is stored and how it survives a power failure. An image is refused if it is incomplete, of an
//! unknown layout, or not valid. The device then uses the defaults and latches `SettingsInvalid`. An image is never used in part.
//! An image of another layout stays in flash until its page is needed, so the previous firmware finds its settings again.

use crate::frame::{PAYLOAD_MAX, crc_of};
use crate::settings::{DeviceSettings, SettingsError};

/// The form of the image that this chip writes, and the data in it.
#[cfg_attr(feature = "large", path = "stored/large.rs")]
#[cfg_attr(not(feature = "large"), path = "stored/small.rs")]
mod form;

pub use form::*;

/// Layout version without an environment (further walls, end stops, detents), which boards without room for one write. The rule
/// for a new number is that of [`LAYOUT_VERSION`]. 9 and 10 are used up: several layouts had them.
const WALL_ALONE: u16 = 11;

/// Longest image of the settings in flash, in bytes.
pub const IMAGE_MAX: usize = VERSION_BYTES + PAYLOAD_MAX + form::BESIDE_MAX + CRC_BYTES;

const VERSION_BYTES: usize = 2;
const CRC_BYTES: usize = 4;

/// A function that checks settings; on a device it is `touchstone_drive::wire::checked`.
pub type Check<'c> = &'c dyn Fn(&DeviceSettings) -> Result<(), SettingsError>;

/// Why an image of settings from the flash is refused.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Refused {
    /// The image is too short, its CRC is wrong, or its content cannot be decoded.
    Damaged,
    /// The image is undamaged but has this other layout version.
    OtherLayout(u16),
    /// The image is undamaged, but this setting is not valid.
    Invalid(SettingsError),
}

fn sealed<'b>(
    content_of: &impl serde::Serialize,
    buffer: &'b mut [u8],
) -> Result<&'b [u8], postcard::Error> {
    const FULL: postcard::Error = postcard::Error::SerializeBufferFull;
    let (version, rest) = buffer
        .split_first_chunk_mut::<VERSION_BYTES>()
        .ok_or(FULL)?;
    *version = LAYOUT_VERSION.to_le_bytes();
    let content = VERSION_BYTES + postcard::to_slice(content_of, rest)?.len();
    let sum = crc_of(buffer.get(..content).ok_or(FULL)?);
    let place = buffer.get_mut(content..content + CRC_BYTES).ok_or(FULL)?;
    place.copy_from_slice(&sum.to_le_bytes());
    buffer.get(..content + CRC_BYTES).ok_or(FULL)
}

/// The layout version of an image of settings; `None` if the image's CRC is wrong.
#[must_use]
pub fn layout_version(image: &[u8]) -> Option<u16> {
    let (signed, sum) = image.split_last_chunk::<CRC_BYTES>()?;
    if crc_of(signed).to_le_bytes() != *sum {
        return None;
    }
    let (version, _) = signed.split_first_chunk::<VERSION_BYTES>()?;
    Some(u16::from_le_bytes(*version))
}

/// Whether this program can read an image with this layout version.
pub(crate) const fn is_readable(version: u16) -> bool {
    version == LAYOUT_VERSION || version == WALL_ALONE
}

/// Checks the CRC of an image and returns its layout version and its content.
fn content(image: &[u8]) -> Result<(u16, &[u8]), Refused> {
    let version = layout_version(image).ok_or(Refused::Damaged)?;
    if !is_readable(version) {
        return Err(Refused::OtherLayout(version));
    }
    image
        .get(VERSION_BYTES..image.len().saturating_sub(CRC_BYTES))
        .map(|content| (version, content))
        .ok_or(Refused::Damaged)
}

/// Chooses the data with which the device starts: those of the image, or the defaults if there is no image or it is refused.
#[must_use]
pub fn start(image: Option<&[u8]>, defaults: DeviceSettings, check: Check<'_>) -> Start {
    match image.map(|image| form::read(image, check)) {
        None => Start::defaults(defaults, None),
        Some(Err(refused)) => Start::defaults(defaults, Some(refused)),
        Some(Ok(start)) => start,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Board;

    /// The number of the layout, and the length and CRC-32 of what is stored in it. If this differs from what a test expects, raise
    /// the number as [`LAYOUT_VERSION`] says and enter the new values.
    pub(super) fn pinned(version: u16, content: &[u8]) -> (u16, usize, u32) {
        (version, content.len(), crc_of(content))
    }

    #[test]
    fn the_settings_are_stored_as_their_layout_version_says() {
        let mut buffer = [0; IMAGE_MAX];
        let settings = DeviceSettings::defaults(Board::NucleoG474re);
        let content = postcard::to_slice(&settings, &mut buffer).expect("room");
        assert_eq!(pinned(WALL_ALONE, content), (11, 257, 0xc184_f19b));
    }

    /// Checks that an image of a number that several layouts had is not read as a damaged one.
    #[test]
    fn a_layout_of_another_number_is_refused_as_such() {
        let mut buffer = [0; IMAGE_MAX];
        let settings = DeviceSettings::defaults(Board::NucleoG474re);
        let length = encode(&settings, &mut buffer).expect("room").len();
        for version in [9_u16, 10] {
            let (signed, sum) = buffer[..length]
                .split_last_chunk_mut::<CRC_BYTES>()
                .expect("a CRC");
            signed[..VERSION_BYTES].copy_from_slice(&version.to_le_bytes());
            *sum = crc_of(signed).to_le_bytes();
            assert_eq!(
                decode(&buffer[..length], &|_| Ok(())),
                Err(Refused::OtherLayout(version))
            );
        }
    }
}
