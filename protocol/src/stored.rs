//! The settings as they lie in flash: layout, content, CRC.
//!
//! ```text
//! layout version u16 | postcard of DeviceSettings | CRC-32 of all before
//! layout version u16 | postcard of DeviceSettings | postcard of Surround | CRC-32 of all before
//! layout version u16 | postcard of DeviceSettings | postcard of Surround | postcard of KeptStart | CRC-32 of all before
//! layout version u16 | the same | postcard of the map of the cogging, if one is kept | CRC-32 of all before
//! ```
//!
//! The last form is that of boards with room for an environment. They read the others as well, with the wall alone, with nothing kept
//! for the start, and with no map.
//!
//! Where it lies, and how it survives a cut of power, is in `flash.rs`. What is not whole, of this layout, and valid is refused:
//! the device then uses the defaults and latches `SettingsInvalid`. There is no guessing at half of an image. An image of
//! another layout is left alone until its place is needed, so that a step back to the firmware before finds its settings.

use crate::frame::{PAYLOAD_MAX, crc_of};
#[cfg(feature = "large")]
use crate::settings::cogging::KeptCogging;
#[cfg(feature = "large")]
use crate::settings::environment::{Surround, WithoutProfile};
#[cfg(feature = "large")]
use crate::settings::kept::KeptStart;
use crate::settings::{DeviceSettings, SettingsError};

/// Version of the layout: raised whenever [`DeviceSettings`] changes its fields, their order or their meaning.
pub const LAYOUT_VERSION: u16 = if cfg!(feature = "large") {
    8
} else {
    WALL_ALONE
};

/// The layout without an environment: that of boards without room for one, and of all before there was one.
const WALL_ALONE: u16 = 4;

/// The layout with an environment and nothing kept for the start.
const NOTHING_KEPT: u16 = 5;

/// The layout without a map of the cogging.
const NO_MAP: u16 = 6;

/// The layout with a map of the cogging, and an environment without a profile.
const NO_PROFILE: u16 = 7;

/// No image is longer, bytes.
pub const IMAGE_MAX: usize = VERSION_BYTES + PAYLOAD_MAX + SURROUND_MAX + CRC_BYTES;

#[cfg(feature = "large")]
const SURROUND_MAX: usize = crate::settings::environment::ENVIRONMENT_MAX
    + crate::settings::kept::KEPT_MAX
    + crate::settings::cogging::COGGING_MAX;
#[cfg(not(feature = "large"))]
const SURROUND_MAX: usize = 0;

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

/// The data with which a device starts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Start {
    /// The settings to use.
    pub settings: DeviceSettings,
    /// What there is to touch.
    #[cfg(feature = "large")]
    pub environment: Surround,
    /// The data that are kept for the next start.
    #[cfg(feature = "large")]
    pub kept: KeptStart,
    /// The map of the cogging, if one is kept.
    #[cfg(feature = "large")]
    pub cogging: Option<KeptCogging>,
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
    #[cfg(not(feature = "large"))]
    return sealed(settings, buffer);
    #[cfg(feature = "large")]
    encode_with(
        settings,
        &Surround::default(),
        &KeptStart::default(),
        None,
        buffer,
    )
}

/// Encodes the image: settings, environment, what is kept for the start, and the cogging map.
///
/// # Errors
/// The buffer is too small; [`IMAGE_MAX`] bytes are always enough.
#[cfg(feature = "large")]
pub fn encode_with<'b>(
    settings: &DeviceSettings,
    environment: &Surround,
    kept: &KeptStart,
    cogging: Option<&KeptCogging>,
    buffer: &'b mut [u8],
) -> Result<&'b [u8], postcard::Error> {
    sealed(&(settings, environment, kept, cogging), buffer)
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

/// Whether this program can read an image of this layout.
pub(crate) const fn is_readable(version: u16) -> bool {
    version == LAYOUT_VERSION
        || version == WALL_ALONE
        || (cfg!(feature = "large") && matches!(version, NOTHING_KEPT | NO_MAP | NO_PROFILE))
}

/// The content of an image, and its layout.
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

/// Decodes an image: settings, environment, what is kept for the start and the cogging map. `check` validates them,
/// also against each other.
///
/// # Errors
/// An image that is damaged, of an unknown layout, or not valid.
#[cfg(feature = "large")]
pub fn decode_with(image: &[u8], check: Check<'_>) -> Result<Start, Refused> {
    use crate::frame::message;
    let (version, content) = content(image)?;
    let (none, wall) = (KeptStart::default(), Surround::default());
    type Read = (DeviceSettings, Surround, KeptStart, Option<KeptCogging>);
    let read: Option<Read> = match version {
        WALL_ALONE => message(content).map(|it| (it, wall, none, None)),
        NOTHING_KEPT => message(content)
            .map(|(it, around): (_, WithoutProfile)| (it, around.into(), none, None)),
        NO_MAP => message(content)
            .map(|(it, around, kept): (_, WithoutProfile, _)| (it, around.into(), kept, None)),
        NO_PROFILE => message(content).map(|(it, around, kept, map): (_, WithoutProfile, _, _)| {
            (it, around.into(), kept, map)
        }),
        _ => message(content),
    };
    let (settings, environment, kept, cogging) = read.ok_or(Refused::Damaged)?;
    check(&settings)
        .and_then(|()| environment.check(&settings))
        .map_err(Refused::Invalid)?;
    Ok(Start {
        environment,
        kept,
        cogging,
        ..Start::defaults(settings, None)
    })
}

/// The settings of an image, validated by `check`.
///
/// # Errors
/// The stored data are incomplete, of another layout, or not valid.
#[cfg(feature = "large")]
pub fn decode(image: &[u8], check: Check<'_>) -> Result<DeviceSettings, Refused> {
    decode_with(image, check).map(|start| start.settings)
}

/// The settings of an image, validated by `check`.
///
/// # Errors
/// The stored data are incomplete, of another layout, or not valid.
#[cfg(not(feature = "large"))]
pub fn decode(image: &[u8], check: Check<'_>) -> Result<DeviceSettings, Refused> {
    let (_, content) = content(image)?;
    let settings: DeviceSettings = crate::frame::message(content).ok_or(Refused::Damaged)?;
    match check(&settings) {
        Ok(()) => Ok(settings),
        Err(invalid) => Err(Refused::Invalid(invalid)),
    }
}

/// What the device starts with: the stored settings, or the defaults where nothing is stored or the stored settings
/// are refused.
#[must_use]
pub fn start(image: Option<&[u8]>, defaults: DeviceSettings, check: Check<'_>) -> Start {
    #[cfg(not(feature = "large"))]
    let read = image.map(|image| decode(image, check));
    #[cfg(feature = "large")]
    let read = image.map(|image| decode_with(image, check));
    match read {
        None => Start::defaults(defaults, None),
        Some(Err(refused)) => Start::defaults(defaults, Some(refused)),
        #[cfg(not(feature = "large"))]
        Some(Ok(settings)) => Start::defaults(settings, None),
        #[cfg(feature = "large")]
        Some(Ok(start)) => start,
    }
}

impl Start {
    /// A start with these settings and one wall.
    pub(crate) fn defaults(settings: DeviceSettings, refused: Option<Refused>) -> Self {
        Self {
            settings,
            #[cfg(feature = "large")]
            environment: Surround::default(),
            #[cfg(feature = "large")]
            kept: KeptStart::default(),
            #[cfg(feature = "large")]
            cogging: None,
            refused,
        }
    }
}
