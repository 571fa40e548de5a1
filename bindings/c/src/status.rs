//! Status codes that the C functions of this library return.

use core::ffi::c_char;

/// Result of a call. `TS_OK` is 0. With any other result the output (force or energy) is 0, so that firmware that ignores it drives
/// no motor.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(non_camel_case_types, clippy::upper_case_acronyms)]
pub enum ts_status {
    /// The call succeeded.
    TS_OK = 0,
    /// A pointer argument is null.
    TS_NULL_POINTER = 1,
    /// The object was never initialised, or its memory was overwritten. Call its `init` function.
    TS_NOT_INITIALISED = 2,
    /// A setting is refused. `ts_guard_check`, `ts_settings_check` and `ts_feel_check` report which setting.
    TS_OUT_OF_RANGE = 3,
    /// There is no setting with the given path.
    TS_UNKNOWN_SETTING = 4,
    /// The text is not a valid value of the setting.
    TS_BAD_VALUE = 5,
    /// The device moved faster than the energy guard's setting `overspeed`. The output force stays 0 until the guard or the wall is
    /// resumed: switch the motor off.
    TS_OVERSPEED = 6,
    /// The guard's `change_is_measured` asks for the other tick function: `ts_guard_tick_with_change` if it is 1, `ts_guard_tick`
    /// if it is 0. The guard's account is emptied if a force acted.
    TS_WRONG_TICK = 7,
}

/// The meaning of a `ts_status` as text, for a log. Never null.
#[unsafe(no_mangle)]
#[allow(unsafe_code)]
pub extern "C" fn ts_status_text(status: i32) -> *const c_char {
    let text: &core::ffi::CStr = match status {
        0 => c"done",
        1 => c"a pointer is null",
        2 => c"the object was never initialised, or its memory was overwritten: call its init function",
        3 => c"a setting is out of its range: ts_guard_check or ts_settings_check names it",
        4 => c"no setting has this name: docs list them, or `touchstone config schema`",
        5 => c"the text is not a value of this setting",
        6 => c"the device moved faster than the guard's overspeed: switch the motor off",
        7 => c"the guard's change_is_measured asks for the other tick function",
        _ => c"no status of this library",
    };
    text.as_ptr()
}
