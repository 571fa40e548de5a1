//! Status codes that the C functions of this library return.

use crate::memory;
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
    /// A setting is out of its range. `ts_guard_check` and `ts_settings_check` report which setting.
    TS_OUT_OF_RANGE = 3,
    /// There is no setting with the given path.
    TS_UNKNOWN_SETTING = 4,
    /// The text is not a valid value of the setting.
    TS_BAD_VALUE = 5,
    /// The device moved faster than the energy guard's setting `overspeed`. The output force stays 0 until the guard or the wall is
    /// resumed: switch the motor off.
    TS_OVERSPEED = 6,
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
        _ => c"no status of this library",
    };
    text.as_ptr()
}

/// Writes an error message into a C buffer. The text is cut to the buffer's length and ends with a zero byte.
pub(crate) struct Words<'a> {
    buffer: &'a mut [u8],
    used: usize,
}

impl<'a> Words<'a> {
    /// Starts an empty text in a buffer. The buffer's last byte is kept for the final zero.
    pub(crate) fn new(buffer: &'a mut [u8]) -> Self {
        memory::terminate(buffer, 0);
        Self { buffer, used: 0 }
    }
}

impl core::fmt::Write for Words<'_> {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        for byte in text.bytes() {
            // One byte is kept for the final zero.
            if self.used.saturating_add(1) >= self.buffer.len() {
                break;
            }
            if let Some(place) = self.buffer.get_mut(self.used) {
                *place = byte;
                self.used = self.used.saturating_add(1);
            }
        }
        memory::terminate(self.buffer, self.used);
        Ok(())
    }
}
