//! All settings of a virtual wall, by the names (paths) that scene files and boards use.

use crate::memory::{self, Object, assert_room};
use crate::message::Words;
use crate::status::ts_status;
use core::ffi::c_char;
use core::fmt::Write as _;
use touchstone_control::{Controller, Fixed32, NotSet, PositionSettings, Settings};

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
        Ok(_) => ts_status::TS_OK,
        Err(problem) => {
            // Writing to a buffer cuts the text; it never fails.
            let _ = write!(words, "{problem}");
            ts_status::TS_OUT_OF_RANGE
        }
    }
}
