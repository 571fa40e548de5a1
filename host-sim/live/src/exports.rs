//! The WebAssembly functions that the page's JavaScript calls by name. Numbers are arguments and results; texts go through one
//! shared buffer.
//!
//! A handle is a number that names a simulated loop. A row of numbers is returned as its address in the memory of the WebAssembly
//! module. The address of a row is valid until the next call with the same handle. The address of the buffer is valid until the
//! next call that reads or writes a text. A function that returns −1 has left the text of the error in the buffer.
//!
//! The attribute `unsafe(no_mangle)` exports a function under its own name. Rust counts the attribute as unsafe because the linker
//! could confuse two functions of the same name. Every exported name begins with `live_`, and no other crate exports such a name.
//! The crate has no other unsafe code.
#![allow(unsafe_code)]

use crate::desk::Desk;
use std::cell::RefCell;
use touchstone_sim::error::Result;

thread_local! {
    static DESK: RefCell<Desk> = RefCell::default();
    static TEXT: RefCell<Vec<u8>> = RefCell::default();
}

fn desk<T>(with: impl FnOnce(&mut Desk) -> T) -> T {
    DESK.with_borrow_mut(with)
}

pub(crate) fn take() -> String {
    TEXT.with_borrow(|text| String::from_utf8_lossy(text).into_owned())
}

pub(crate) fn give(text: String) {
    TEXT.set(text.into_bytes());
}

/// Returns a copy of the bytes in the shared text buffer.
pub(crate) fn take_bytes() -> Vec<u8> {
    TEXT.with_borrow(Clone::clone)
}

/// Puts bytes into the shared text buffer; returns how many.
pub(crate) fn give_bytes(bytes: Vec<u8>) -> usize {
    let count = bytes.len();
    TEXT.set(bytes);
    count
}

/// Returns the number in `result`. If `result` is an error, puts the error's text into the shared buffer and returns −1.
pub(crate) fn number(result: Result<i32>) -> i32 {
    result.unwrap_or_else(|error| {
        give(error.to_string());
        -1
    })
}

/// Makes room for a text of `bytes` bytes in the shared buffer; returns the address at which the caller writes the text.
#[unsafe(no_mangle)]
extern "C" fn live_text_room(bytes: usize) -> *mut u8 {
    TEXT.with_borrow_mut(|text| {
        text.clear();
        text.resize(bytes, 0);
        text.as_mut_ptr()
    })
}

/// Address of the text in the shared buffer.
#[unsafe(no_mangle)]
extern "C" fn live_text() -> *const u8 {
    TEXT.with_borrow(|text| text.as_ptr())
}

/// Length in bytes of the text in the shared buffer.
#[unsafe(no_mangle)]
extern "C" fn live_text_bytes() -> usize {
    TEXT.with_borrow(Vec::len)
}

/// Opens a simulated loop with the scene (TOML description of the simulation) in the shared text buffer. Returns the loop's handle,
/// or −1 after an error.
#[unsafe(no_mangle)]
extern "C" fn live_open() -> i32 {
    number(desk(|desk| desk.open(&take())).map(|handle| handle as i32))
}

/// Closes the simulated loop with this handle.
#[unsafe(no_mangle)]
extern "C" fn live_close(handle: usize) {
    desk(|desk| desk.close(handle));
}

/// Changes a running loop to the scene (TOML description of the simulation) in the shared text buffer; device and hand keep their
/// positions. Returns 0, or −1 after an error.
#[unsafe(no_mangle)]
extern "C" fn live_change(handle: usize) -> i32 {
    number(desk(|desk| desk.change(handle, &take())).map(|()| 0))
}

/// Restarts a simulated loop from the beginning of its simulation. Returns 0, or −1 after an error.
#[unsafe(no_mangle)]
extern "C" fn live_reset(handle: usize) -> i32 {
    number(desk(|desk| desk.reset(handle)).map(|()| 0))
}

/// Runs one control period with the rest point of the hand's spring at `rest_rad`, in radians. Returns the address of the numbers
/// named in `desk::ROW`, or 0 for an unknown handle.
#[unsafe(no_mangle)]
extern "C" fn live_tick(handle: usize, rest_rad: f64) -> *const f64 {
    desk(|desk| {
        desk.tick(handle, rest_rad)
            .map_or(std::ptr::null(), |row| row.as_ptr())
    })
}

/// Rest point of the hand's spring at `time_s`, in radians, in the hand motion that the loop's scene file prescribes. NaN without
/// such a motion, for a recorded one, and for an unknown handle.
#[unsafe(no_mangle)]
extern "C" fn live_own_rest(handle: usize, time_s: f64) -> f64 {
    desk(|desk| desk.own_rest_rad(handle, time_s))
}

/// Address of the numbers named in `desk::FACTS`, which describe the simulated loop and change only with its settings; 0 for an
/// unknown handle.
#[unsafe(no_mangle)]
extern "C" fn live_facts(handle: usize) -> *const f64 {
    desk(|desk| {
        desk.facts(handle)
            .map_or(std::ptr::null(), |facts| facts.as_ptr())
    })
}

/// Puts the loop's scene (description of the simulation) into the shared buffer, as TOML text with every value.
#[unsafe(no_mangle)]
extern "C" fn live_printed(handle: usize) {
    give(desk(|desk| desk.printed(handle)));
}

/// Puts a TOML description of a simulation that repeats the loop's control periods into the shared buffer. Before the call, the
/// buffer must hold the name of the file with the hand's rest points.
#[unsafe(no_mangle)]
extern "C" fn live_replay(handle: usize) {
    give(desk(|desk| desk.replay(handle, &take())));
}

/// Puts the passivity conditions that the loop's settings violate into the shared buffer, one per line.
#[unsafe(no_mangle)]
extern "C" fn live_warnings(handle: usize) {
    give(desk(|desk| desk.warnings(handle)));
}
