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
#[cfg(feature = "large")]
use crate::settings::cogging::KeptCogging;
#[cfg(feature = "large")]
use crate::settings::environment::Surround;
#[cfg(feature = "large")]
use crate::settings::kept::KeptStart;
use crate::settings::{DeviceSettings, SettingsError};

/// Version of the layout. It must rise when the fields of [`DeviceSettings`], their order or their meaning change.
pub const LAYOUT_VERSION: u16 = if cfg!(feature = "large") {
    10
} else {
    WALL_ALONE
};

/// Layout version without an environment (further walls, end stops, detents), which boards without room for one write.
const WALL_ALONE: u16 = 9;

/// Longest image of the settings in flash, in bytes.
pub const IMAGE_MAX: usize = VERSION_BYTES + PAYLOAD_MAX + SURROUND_MAX + CRC_BYTES;

#[cfg(feature = "large")]
const SURROUND_MAX: usize = crate::settings::environment::ENVIRONMENT_MAX
    + crate::settings::kept::KEPT_MAX
    + crate::settings::cogging::COGGING_MAX;
#[cfg(not(feature = "large"))]
const SURROUND_MAX: usize = 0;

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

/// The data with which a device starts: settings, environment (walls, end stops, detents), encoder alignment and cogging map.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Start {
    /// The settings to use.
    pub settings: DeviceSettings,
    /// The environment that the knob renders: walls, end stops, detents and torque profile.
    #[cfg(feature = "large")]
    pub environment: Surround,
    /// The data stored for the next start: the encoder's alignment and whether the board starts by itself.
    #[cfg(feature = "large")]
    pub kept: KeptStart,
    /// The map of the motor's cogging torque, if one is stored.
    #[cfg(feature = "large")]
    pub cogging: Option<KeptCogging>,
    /// Why the defaults are used although an image was stored. The device then latches `SettingsInvalid`.
    pub refused: Option<Refused>,
}

/// Encodes the image of the settings into `buffer`.
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

/// Encodes the image of the settings, the environment, the data for the next start, and the cogging map.
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

/// Decodes an image: settings, environment, the data for the start, and the cogging map. `check` validates the settings, and the
/// environment is checked against them.
///
/// # Errors
/// The image is damaged, of an unknown layout, or not valid.
#[cfg(feature = "large")]
pub fn decode_with(image: &[u8], check: Check<'_>) -> Result<Start, Refused> {
    use crate::frame::message;
    let (version, content) = content(image)?;
    type Read = (DeviceSettings, Surround, KeptStart, Option<KeptCogging>);
    let read: Option<Read> = match version {
        WALL_ALONE => {
            message(content).map(|it| (it, Surround::default(), KeptStart::default(), None))
        }
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

/// Decodes the settings of an image. `check` validates them.
///
/// # Errors
/// The image is damaged, of an unknown layout, or not valid.
#[cfg(feature = "large")]
pub fn decode(image: &[u8], check: Check<'_>) -> Result<DeviceSettings, Refused> {
    decode_with(image, check).map(|start| start.settings)
}

/// Decodes the settings of an image. `check` validates them.
///
/// # Errors
/// The image is damaged, of an unknown layout, or not valid.
#[cfg(not(feature = "large"))]
pub fn decode(image: &[u8], check: Check<'_>) -> Result<DeviceSettings, Refused> {
    let (_, content) = content(image)?;
    let settings: DeviceSettings = crate::frame::message(content).ok_or(Refused::Damaged)?;
    match check(&settings) {
        Ok(()) => Ok(settings),
        Err(invalid) => Err(Refused::Invalid(invalid)),
    }
}

/// Chooses the data with which the device starts: those of the image, or the defaults if there is no image or it is refused.
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
    /// A start with these settings, one wall and no stored data. `refused` is the reason if an image was refused.
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

#[cfg(all(test, feature = "large"))]
mod tests {
    use super::*;
    use crate::settings::environment::DetentsBeside;
    use crate::{Board, Decimal};
    use touchstone_control::Si;

    #[test]
    fn a_stored_environment_that_is_not_valid_means_defaults_and_says_so() {
        let settings = DeviceSettings::defaults(Board::NucleoG474re);
        let with = |strength_n_m: &str| Surround {
            detents: Some(DetentsBeside {
                per_rev: 24,
                pitch_rad: Decimal(Si::ZERO),
                strength_n_m: Decimal(strength_n_m.parse().expect("a number")),
                centre_rad: Decimal(Si::ZERO),
            }),
            ..Surround::default()
        };
        let mut buffer = [0; IMAGE_MAX];
        let mut start_with = |environment: &Surround| {
            let kept = KeptStart::default();
            let image = encode_with(&settings, environment, &kept, None, &mut buffer);
            start(Some(image.expect("room")), settings.clone(), &|_| Ok(()))
        };
        let good = with("0.02");
        let start = start_with(&good);
        assert_eq!((start.environment, start.refused), (good, None));
        // More than the force limit.
        let start = start_with(&with("100"));
        assert_eq!(start.environment, Surround::default());
        match start.refused {
            Some(Refused::Invalid(why)) => assert_eq!(why.path, "environment.detents.strength_n_m"),
            other => panic!("{other:?}"),
        }
    }
}
