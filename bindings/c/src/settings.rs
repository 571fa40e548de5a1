//! All settings of a virtual wall, by the names (paths) that scene files and boards use.

use crate::memory::{self, Object, assert_room};
use crate::message::Words;
use crate::status::ts_status;
use core::ffi::c_char;
use core::fmt::Write as _;
use touchstone_control::{ChangeOfForce, Controller, Fixed32, NotSet, PositionSettings, Settings};

/// Size of a `ts_settings` in 64-bit words.
pub const TS_SETTINGS_WORDS: usize = 64;

/// The settings of a virtual wall. Initialise them with `ts_settings_init`.
#[repr(C)]
#[allow(non_camel_case_types)]
pub struct ts_settings {
    memory: [u64; TS_SETTINGS_WORDS],
}

// SAFETY: `assert_room!` below checks size and alignment.
#[allow(unsafe_code)]
unsafe impl Object for ts_settings {
    type Value = Settings;
    const MARK: u64 = 0x7473_7365_7474_6967;
}
assert_room!(ts_settings);

/// Whether the energy guard relies on a second position in each tick, measured when the force changes. `ts_wall_tick` and
/// `ts_feel_tick` get none: the guard would count every displacement under the new force, and its energy bound would not hold.
pub(crate) fn lacks_second_reading(settings: &Settings) -> bool {
    settings.guard.on && settings.guard.change == ChangeOfForce::Measured
}

/// Writes why settings without a second position are refused.
pub(crate) fn explain_second_reading(words: &mut Words<'_>) {
    // Writing to a buffer cuts the text; it never fails.
    let _ = write!(
        words,
        "law.guard.change = measured: a wall or feel in C gets one position a tick, so the energy bound would fail; give estimated"
    );
}

/// Borrows the settings of a wall or feel. Errors: those of [`memory::value`], and a guard that relies on a second position.
pub(crate) fn of_one_reading<'a>(
    settings: *mut ts_settings,
) -> Result<&'a mut Settings, ts_status> {
    let settings = memory::value(settings)?;
    if lacks_second_reading(settings) {
        return Err(ts_status::TS_OUT_OF_RANGE);
    }
    Ok(settings)
}

/// Sets all settings to the defaults, which describe the virtual wall on Touchstone's simulated knob. Change at least those that
/// differ on your device.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_settings_init(settings: *mut ts_settings) -> ts_status {
    memory::initialise(settings, Settings::default())
}

/// Sets one setting, named by its path, from a text that is a decimal number or a word: `"wall.k_desired_n_m_per_rad"`, `"5"`;
/// `"law.kind"`, `"spring-damper"`. The range is checked later, by `ts_settings_check` or `ts_wall_init`.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_settings_set(
    settings: *mut ts_settings,
    path: *const c_char,
    value: *const c_char,
) -> ts_status {
    match (
        memory::value(settings),
        memory::text(path),
        memory::text(value),
    ) {
        (Ok(settings), Ok(path), Ok(value)) => match settings.set_by_path(path, value) {
            Ok(()) => ts_status::TS_OK,
            Err(NotSet::UnknownPath) => ts_status::TS_UNKNOWN_SETTING,
            Err(_) => ts_status::TS_BAD_VALUE,
        },
        (Err(status), ..) | (_, Err(status), _) | (.., Err(status)) => status,
    }
}

/// Sets the encoder's resolution, which speed estimator and energy guard use: counts per turn with all edges counted, at least 1.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_settings_set_counts_per_rev(
    settings: *mut ts_settings,
    counts_per_rev: u32,
) -> ts_status {
    match memory::value(settings) {
        Err(status) => status,
        Ok(_) if counts_per_rev == 0 => ts_status::TS_BAD_VALUE,
        Ok(settings) => {
            settings.position = PositionSettings::of_counts_per_rev(counts_per_rev);
            ts_status::TS_OK
        }
    }
}

/// Checks all settings of a virtual wall together. If they are refused, `message` gets the reason in one line, with the setting's
/// name and range; `message` may be null.
///
/// A guard with `law.guard.change = measured` is refused, because `ts_wall_tick` gets no second position: give `estimated`.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_settings_check(
    settings: *mut ts_settings,
    message: *mut c_char,
    length: usize,
) -> ts_status {
    let mut words = Words::new(memory::buffer(message, length));
    let settings = match memory::value(settings) {
        Ok(settings) => settings,
        Err(status) => return status,
    };
    match Controller::<Fixed32>::new(settings) {
        Ok(_) if lacks_second_reading(settings) => {
            explain_second_reading(&mut words);
            ts_status::TS_OUT_OF_RANGE
        }
        Ok(_) => ts_status::TS_OK,
        Err(problem) => {
            // Writing to a buffer cuts the text; it never fails.
            let _ = write!(words, "{problem}");
            ts_status::TS_OUT_OF_RANGE
        }
    }
}
