//! Passes the environment (further walls, end stops, detents) and the cogging map from the main thread to the control interrupt.

use touchstone_drive::around::Surrounding;
use touchstone_drive::cogging::Played;
use touchstone_drive::{DeviceSettings, SettingsError};
use touchstone_protocol::{CoggingMap, CountsFrom, Surround};

use crate::clock::CORE_HZ;
use crate::control::{AROUND, Control, control};
use crate::shared::InThread;
use crate::{board, cycles};

/// Longest wait for a control period's second encoder reading, in processor cycles: two control periods at the slowest rate, 500
/// Hz. A missing reading must not block the main thread.
const READING_PATIENCE: u32 = 2 * (CORE_HZ / 500);

/// Same as [`control`], but waits until no second encoder reading is due in the present control period, at most
/// [`READING_PATIENCE`]. For a copy that takes so long that it would make that reading too late.
fn control_after_reading<R>(here: InThread, look: impl FnOnce(&mut Control) -> R) -> Option<R> {
    let begun = cycles::now();
    let mut look = Some(look);
    loop {
        let is_late = cycles::now().wrapping_sub(begun) > READING_PATIENCE;
        let looked = control(here, |control| {
            if control.device.awaits_reading() && !is_late {
                return None;
            }
            look.take().map(|look| look(control))
        });
        match looked {
            Some(None) if !is_late => {}
            looked => return looked.flatten(),
        }
    }
}

/// Checks and computes an environment (walls, end stops, detents), and hands it to the control interrupt. Returns the time from
/// which it is rendered; `None` if the control interrupt's data do not exist yet. The computation runs with the control interrupt
/// enabled. Only the copy of some kilobytes masks it, after the control period's second encoder reading.
#[inline(never)]
pub fn give(
    here: InThread,
    settings: &DeviceSettings,
    environment: &Surround,
) -> Result<Option<CountsFrom>, SettingsError> {
    let surrounding = Surrounding::new(settings, &board::HARDWARE, environment)?;
    Ok(control_after_reading(here, |control| {
        AROUND.in_thread(here, |around| control.device.surround(around, &surrounding))
    }))
}

/// Computes the table of the cogging map and hands it to the control interrupt. With `None` no cogging is compensated.
#[inline(never)]
pub fn play(here: InThread, settings: &DeviceSettings, map: Option<&CoggingMap>) {
    let played = map.map(|map| Played::new(map, settings, &board::HARDWARE));
    control_after_reading(here, |control| {
        AROUND.in_thread(here, |around| control.device.play(around, played.as_ref()));
    });
}
