//! The image of the settings in flash, through a sequential-storage map: wear is spread over the pages, and a cut of power at any
//! write loses nothing but that write.
//!
//! The map's key is the layout version, so that firmware of another layout leaves this one's image alone.

use crate::session::FlashError;
use crate::settings::DeviceSettings;
use crate::stored::{self, Check, LAYOUT_VERSION, Start};
use core::ops::Range;
use embedded_storage_async::nor_flash::NorFlash;
use sequential_storage::cache::Cache;
use sequential_storage::map::{MapConfig, MapStorage};

/// Room for key and image, rounded up to the largest word of any flash here.
const BUFFER: usize = (stored::IMAGE_MAX + 2).next_multiple_of(32);

/// What to start with. A flash that cannot be read at all counts as damaged settings.
pub async fn load<F: NorFlash>(
    flash: F,
    pages: Range<u32>,
    defaults: DeviceSettings,
    check: Check<'_>,
) -> Start {
    let mut buffer = [0; BUFFER];
    let Ok(config) = MapConfig::try_new(pages) else {
        return stored::start(Some(&[]), defaults, check);
    };
    let mut map = MapStorage::<u16, F, _>::new(flash, config, Cache::new_uncached());
    match map.fetch_item::<&[u8]>(&mut buffer, &LAYOUT_VERSION).await {
        Ok(image) => stored::start(image, defaults, check),
        Err(_) => stored::start(Some(&[]), defaults, check),
    }
}

/// Writes an image. A map that cannot be repaired is erased and begun anew, as then there is nothing in it to lose.
///
/// # Errors
/// The flash refused.
pub async fn save<F: NorFlash>(
    flash: F,
    pages: Range<u32>,
    image: &[u8],
) -> Result<(), FlashError> {
    let mut buffer = [0; BUFFER];
    let config = MapConfig::try_new(pages).map_err(|_| FlashError)?;
    let mut map = MapStorage::<u16, F, _>::new(flash, config, Cache::new_uncached());
    let stored = map.store_item(&mut buffer, &LAYOUT_VERSION, &image).await;
    match stored {
        Ok(()) => Ok(()),
        Err(sequential_storage::Error::Corrupted { .. }) => {
            map.erase_all().await.map_err(|_| FlashError)?;
            map.store_item(&mut buffer, &LAYOUT_VERSION, &image)
                .await
                .map_err(|_| FlashError)
        }
        Err(_) => Err(FlashError),
    }
}
