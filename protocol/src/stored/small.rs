//! What chips without room for an environment store: the settings alone. `large.rs` has the same functions for larger chips.

use super::{Check, Refused, WALL_ALONE, content, sealed};
use crate::settings::DeviceSettings;

/// Version of the layout. It must get a number that no layout had before when the fields of [`DeviceSettings`], their order, their
/// types or their meaning change; `large.rs` then needs one too. Otherwise a board takes its stored settings for damaged ones.
pub const LAYOUT_VERSION: u16 = WALL_ALONE;

/// Most bytes that are stored beside the settings.
pub(super) const BESIDE_MAX: usize = 0;

/// The data with which a device starts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Start {
    /// The settings to use.
    pub settings: DeviceSettings,
    /// Why the defaults are used although an image was stored. The device then latches `SettingsInvalid`.
    pub refused: Option<Refused>,
}

impl Start {
    /// A start with these settings. `refused` is the reason if an image was refused.
    pub(crate) fn defaults(settings: DeviceSettings, refused: Option<Refused>) -> Self {
        Self { settings, refused }
    }
}

/// Encodes the image of the settings into `buffer`.
///
/// # Errors
/// The buffer is too small; [`IMAGE_MAX`](super::IMAGE_MAX) bytes are always enough.
pub fn encode<'b>(
    settings: &DeviceSettings,
    buffer: &'b mut [u8],
) -> Result<&'b [u8], postcard::Error> {
    sealed(settings, buffer)
}

/// Decodes the settings of an image. `check` validates them.
///
/// # Errors
/// The image is damaged, of an unknown layout, or not valid.
pub fn decode(image: &[u8], check: Check<'_>) -> Result<DeviceSettings, Refused> {
    let (_, content) = content(image)?;
    let settings: DeviceSettings = crate::frame::message(content).ok_or(Refused::Damaged)?;
    match check(&settings) {
        Ok(()) => Ok(settings),
        Err(invalid) => Err(Refused::Invalid(invalid)),
    }
}

/// Decodes all data of an image with which the device starts.
pub(super) fn read(image: &[u8], check: Check<'_>) -> Result<Start, Refused> {
    decode(image, check).map(|settings| Start::defaults(settings, None))
}
