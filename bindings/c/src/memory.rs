//! Turns memory that C owns into a Rust value. Only this module reads or writes through a pointer.
//!
//! A C object of this library is an array of 64-bit words. `init` writes a mark and the Rust value into it. Every other call checks
//! the mark first, so that zeroed or foreign memory is refused. The mark does not show whether memory was partly overwritten.
#![allow(unsafe_code)]

use crate::status::ts_status;
use core::ffi::{CStr, c_char};

/// Layout of a C object's memory: the mark of its type, followed by the Rust value.
#[repr(C)]
pub struct Marked<T> {
    mark: u64,
    value: T,
}

/// A C type, such as `ts_guard`, whose memory holds a Rust value of one type.
///
/// # Safety
/// The C type must be at least as large and as strictly aligned as `Marked<Self::Value>`; `assert_room!` checks it.
pub unsafe trait Object: Sized {
    /// Type of the Rust value that the C object's memory holds.
    type Value: Copy;
    /// Number that marks initialised memory of this C type; each type has a different number.
    const MARK: u64;
}

/// Fails to compile if the memory of a C type is too small for its Rust value.
macro_rules! assert_room {
    ($object:ty) => {
        const _: () = {
            type Inside = $crate::memory::Marked<<$object as $crate::memory::Object>::Value>;
            assert!(core::mem::size_of::<Inside>() <= core::mem::size_of::<$object>());
            assert!(core::mem::align_of::<Inside>() <= core::mem::align_of::<$object>());
        };
    };
}
pub(crate) use assert_room;

/// Writes the mark of its type and a Rust value into a C object's memory.
pub(crate) fn initialise<O: Object>(object: *mut O, value: O::Value) -> ts_status {
    if object.is_null() {
        return ts_status::TS_NULL_POINTER;
    }
    let marked = Marked {
        mark: O::MARK,
        value,
    };
    // SAFETY: not null, and by the trait's contract large and aligned enough; the caller of the C function owns it.
    unsafe { object.cast::<Marked<O::Value>>().write(marked) };
    ts_status::TS_OK
}

/// Same as [`initialise`], for a large value that is a pair: the parts are written one by one, so that no copy of the pair is on
/// the stack.
#[inline(always)]
pub(crate) fn initialise_pair<O: Object<Value = (A, B)>, A: Copy, B: Copy>(
    object: *mut O,
    first: A,
    second: B,
) -> ts_status {
    if object.is_null() {
        return ts_status::TS_NULL_POINTER;
    }
    let place = object.cast::<Marked<(A, B)>>();
    // SAFETY: as in `initialise`; the pair counts as initialised after both parts and the mark are written.
    unsafe {
        (&raw mut (*place).value.0).write(first);
        (&raw mut (*place).value.1).write(second);
        (&raw mut (*place).mark).write(O::MARK);
    }
    ts_status::TS_OK
}

/// Removes the mark from a C object's memory, so that the object counts as not initialised until `initialise` writes a new value.
pub(crate) fn clear<O: Object>(object: *mut O) -> Result<(), ts_status> {
    if object.is_null() {
        return Err(ts_status::TS_NULL_POINTER);
    }
    // SAFETY: as in `initialise`; the mark is the first word.
    unsafe { object.cast::<u64>().write(0) };
    Ok(())
}

/// Borrows the Rust value in a C object's memory. Errors: the pointer is null, or the object was not initialised.
pub(crate) fn value<'a, O: Object>(object: *mut O) -> Result<&'a mut O::Value, ts_status> {
    if object.is_null() {
        return Err(ts_status::TS_NULL_POINTER);
    }
    // SAFETY: not null, aligned by the trait's contract; every bit pattern is a word.
    let mark = unsafe { object.cast::<u64>().read() };
    if mark != O::MARK {
        return Err(ts_status::TS_NOT_INITIALISED);
    }
    // SAFETY: the mark says that `initialise` wrote the value; the caller of the C function has the object for itself while the
    // call lasts.
    Ok(unsafe { &mut (*object.cast::<Marked<O::Value>>()).value })
}

/// Writes an output value through a pointer that C code passed. Error: the pointer is null.
pub(crate) fn put<T>(place: *mut T, value: T) -> ts_status {
    if place.is_null() {
        return ts_status::TS_NULL_POINTER;
    }
    // SAFETY: not null; the caller of the C function owns a `T` there.
    unsafe { place.write(value) };
    ts_status::TS_OK
}

/// Reads an input structure through a pointer that C code passed. Error: the pointer is null.
pub(crate) fn get<T: Copy>(place: *const T) -> Result<T, ts_status> {
    if place.is_null() {
        return Err(ts_status::TS_NULL_POINTER);
    }
    // SAFETY: not null; the caller of the C function has a whole `T` there.
    Ok(unsafe { place.read() })
}

/// Borrows an input structure through a pointer that C code passed. Error: the pointer is null.
pub(crate) fn borrow<'a, T>(place: *const T) -> Result<&'a T, ts_status> {
    // SAFETY: the caller of the C function has a whole `T` there, which nobody changes while the call lasts.
    unsafe { place.as_ref() }.ok_or(ts_status::TS_NULL_POINTER)
}

/// Borrows the text of a C string. Errors: the pointer is null, or the text is not UTF-8.
pub(crate) fn text<'a>(text: *const c_char) -> Result<&'a str, ts_status> {
    if text.is_null() {
        return Err(ts_status::TS_NULL_POINTER);
    }
    // SAFETY: not null; the caller of the C function ends it with a zero byte.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map_err(|_| ts_status::TS_BAD_VALUE)
}

/// Borrows a C text buffer of `length` bytes as a slice; the slice is empty for a null pointer.
pub(crate) fn buffer<'a>(place: *mut c_char, length: usize) -> &'a mut [u8] {
    if place.is_null() || length == 0 {
        return &mut [];
    }
    // SAFETY: not null; the caller of the C function owns `length` bytes there.
    unsafe { core::slice::from_raw_parts_mut(place.cast::<u8>(), length) }
}

/// Writes the zero byte that ends a C text at the index `at`.
pub(crate) fn terminate(buffer: &mut [u8], at: usize) {
    if let Some(end) = buffer.get_mut(at) {
        *end = 0;
    }
}
