//! What there is to touch beside the wall, and the map of the cogging, from the thread to the control tick.

use touchstone_drive::around::Surrounding;
use touchstone_drive::cogging::Played;
use touchstone_drive::{DeviceSettings, SettingsError};
use touchstone_protocol::{CoggingMap, CountsFrom, Surround};

use crate::board;
use crate::control::AROUND;
use crate::requests::control;
use crate::shared::InThread;

/// Checks and computes an environment, and gives it to the control tick; from when on it counts. Computed before the control tick
/// is held off, which then only waits for the copy.
#[inline(never)]
pub fn give(
    here: InThread,
    settings: &DeviceSettings,
    environment: &Surround,
) -> Result<Option<CountsFrom>, SettingsError> {
    let surrounding = Surrounding::new(settings, &board::HARDWARE, environment)?;
    Ok(control(here, |control| {
        AROUND.in_thread(here, |around| control.device.surround(around, &surrounding))
    }))
}

/// Makes the map of the cogging ready, and gives it to the control tick; `None`: none is played.
#[inline(never)]
pub fn play(here: InThread, settings: &DeviceSettings, map: Option<&CoggingMap>) {
    let played = map.map(|map| Played::new(map, settings, &board::HARDWARE));
    control(here, |control| {
        AROUND.in_thread(here, |around| control.device.play(around, played.as_ref()));
    });
}
