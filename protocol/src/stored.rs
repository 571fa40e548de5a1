//! The settings as they lie in flash: layout, content, CRC.
//!
//! ```text
//! layout version u16 | postcard of DeviceSettings | CRC-32 of all before
//! ```
//!
//! Where it lies, and how it survives a cut of power, is in `flash.rs`. What is not whole, of this layout, and valid is refused:
//! the device then uses the defaults and latches `SettingsInvalid`. There is no guessing at half of an image. An image of
//! another layout is left alone until its place is needed, so that a step back to the firmware before finds its settings.

use crate::frame::{PAYLOAD_MAX, crc_of};
use crate::settings::{DeviceSettings, SettingsError};

/// Version of the layout: raised whenever [`DeviceSettings`] changes its fields, their order or their meaning.
pub const LAYOUT_VERSION: u16 = 4;

/// No image is longer, bytes.
pub const IMAGE_MAX: usize = VERSION_BYTES + PAYLOAD_MAX + CRC_BYTES;

const VERSION_BYTES: usize = 2;
const CRC_BYTES: usize = 4;

/// The check of settings, `touchstone_drive::wire::checked` on a device.
pub type Check<'c> = &'c dyn Fn(&DeviceSettings) -> Result<(), SettingsError>;

/// Why an image is refused.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Refused {
    /// Too short, a wrong CRC, or no settings inside.
    Damaged,
    /// Whole, but of another layout.
    OtherLayout(u16),
    /// Whole, but refused by the validation.
    Invalid(SettingsError),
}

/// What a device starts with.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Start {
    /// The settings to use.
    pub settings: DeviceSettings,
    /// Why they are the defaults although something was stored: the device latches `SettingsInvalid`.
    pub refused: Option<Refused>,
}

/// The image of settings.
///
/// # Errors
/// The buffer is too small; [`IMAGE_MAX`] bytes are always enough.
pub fn encode<'b>(
    settings: &DeviceSettings,
    buffer: &'b mut [u8],
) -> Result<&'b [u8], postcard::Error> {
    const FULL: postcard::Error = postcard::Error::SerializeBufferFull;
    let (version, rest) = buffer
        .split_first_chunk_mut::<VERSION_BYTES>()
        .ok_or(FULL)?;
    *version = LAYOUT_VERSION.to_le_bytes();
    let content = VERSION_BYTES + postcard::to_slice(settings, rest)?.len();
    let sum = crc_of(buffer.get(..content).ok_or(FULL)?);
    let place = buffer.get_mut(content..content + CRC_BYTES).ok_or(FULL)?;
    place.copy_from_slice(&sum.to_le_bytes());
    buffer.get(..content + CRC_BYTES).ok_or(FULL)
}

/// The layout version of an image, if it is whole.
#[must_use]
pub fn layout_version(image: &[u8]) -> Option<u16> {
    let (signed, sum) = image.split_last_chunk::<CRC_BYTES>()?;
    if crc_of(signed).to_le_bytes() != *sum {
        return None;
    }
    let (version, _) = signed.split_first_chunk::<VERSION_BYTES>()?;
    Some(u16::from_le_bytes(*version))
}

/// The settings of an image, validated by `check`.
///
/// # Errors
/// Whatever is not whole, of this layout, and valid.
pub fn decode(image: &[u8], check: Check<'_>) -> Result<DeviceSettings, Refused> {
    let version = layout_version(image).ok_or(Refused::Damaged)?;
    if version != LAYOUT_VERSION {
        return Err(Refused::OtherLayout(version));
    }
    let content = image
        .get(VERSION_BYTES..image.len().saturating_sub(CRC_BYTES))
        .ok_or(Refused::Damaged)?;
    let settings: DeviceSettings = crate::frame::message(content).ok_or(Refused::Damaged)?;
    match check(&settings) {
        Ok(()) => Ok(settings),
        Err(invalid) => Err(Refused::Invalid(invalid)),
    }
}

/// What to start with: the stored settings; the defaults where nothing is stored, or where what is stored is refused.
#[must_use]
pub fn start(image: Option<&[u8]>, defaults: DeviceSettings, check: Check<'_>) -> Start {
    match image.map(|image| decode(image, check)) {
        None => Start {
            settings: defaults,
            refused: None,
        },
        Some(Ok(settings)) => Start {
            settings,
            refused: None,
        },
        Some(Err(refused)) => Start {
            settings: defaults,
            refused: Some(refused),
        },
    }
}
