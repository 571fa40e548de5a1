//! Dereferences the pointers that the importing program passes. No other module dereferences a pointer.
#![allow(unsafe_code)]

use crate::fmi3Status;
use core::ffi::{CStr, c_char, c_void};
use std::ffi::CString;
use touchstone_fmu::model::Model;

/// FMI's function for messages.
pub type LogMessage = extern "C" fn(*mut c_void, fmi3Status, *const c_char, *const c_char);

/// What an `fmi3Instance` points to.
pub struct Instance {
    /// What the FMU calculates.
    pub model: Model,
    /// Whether the instance is between initialisation and termination.
    pub is_running: bool,
    /// Whether the importing program was warned that the law's steps are too long.
    pub is_warned: bool,
    /// Whether the importing program was warned that the angle at the change of torque is missing.
    pub is_warned_of_change: bool,
    /// Where messages go.
    pub log: Log,
}

/// The importing program's function for messages.
#[derive(Debug, Clone, Copy)]
pub struct Log {
    /// The function; `None` if the program gave none.
    pub call: Option<LogMessage>,
    /// A pointer of the program, passed back to it with each message.
    pub environment: *mut c_void,
}

impl Log {
    /// Passes a message to the importing program, and returns `status`.
    pub fn say(&self, status: fmi3Status, message: &str) -> fmi3Status {
        let category = match status {
            fmi3Status::Warning => c"logStatusWarning",
            _ => c"logStatusError",
        };
        if let (Some(call), Ok(message)) = (self.call, CString::new(message.replace('\0', " "))) {
            call(
                self.environment,
                status,
                category.as_ptr(),
                message.as_ptr(),
            );
        }
        status
    }
}

/// Converts an instance to the pointer that the importing program gets. Only `free` frees the instance.
pub(crate) fn give(instance: Instance) -> *mut c_void {
    Box::into_raw(Box::new(instance)).cast()
}

/// Borrows the instance of a call; `None` for a null pointer.
pub(crate) fn instance<'a>(pointer: *mut c_void) -> Option<&'a mut Instance> {
    // SAFETY: null, or from `give`, and the importing program uses an instance in one thread at a time.
    unsafe { pointer.cast::<Instance>().as_mut() }
}

/// Takes an instance back and frees it.
pub(crate) fn free(pointer: *mut c_void) {
    if !pointer.is_null() {
        // SAFETY: from `give`, and the importing program frees an instance once.
        drop(unsafe { Box::from_raw(pointer.cast::<Instance>()) });
    }
}

/// Borrows a text; `None` for a null pointer and for text that is not UTF-8.
pub(crate) fn text<'a>(pointer: *const c_char) -> Option<&'a str> {
    if pointer.is_null() {
        return None;
    }
    // SAFETY: not null; the importing program ends a text with a zero byte.
    unsafe { CStr::from_ptr(pointer) }.to_str().ok()
}

/// Borrows an array of inputs; `None` for a null pointer with a length above 0.
pub(crate) fn array<'a, T>(pointer: *const T, length: usize) -> Option<&'a [T]> {
    match (length, pointer.is_null()) {
        (0, _) => Some(&[]),
        (_, true) => None,
        // SAFETY: not null; the importing program owns `length` values there, and leaves them while the call lasts.
        (_, false) => Some(unsafe { core::slice::from_raw_parts(pointer, length) }),
    }
}

/// Writes a value of an output array; `index` must be below the array's length. Returns false for a null pointer.
pub(crate) fn put<T>(pointer: *mut T, index: usize, value: T) -> bool {
    if !pointer.is_null() {
        // SAFETY: not null; the importing program owns the array, and the callers count no further than its length.
        unsafe { pointer.add(index).write(value) };
    }
    !pointer.is_null()
}
