//! What a page calls, by name: numbers in, numbers out, texts through one shared buffer.
//!
//! Handles stand for loops, addresses for rows of numbers in the module's own memory. A row's address holds until the next call
//! with the same handle; the buffer's until the next call that takes or gives a text. A function that gives −1 has left an error's
//! text in the buffer.
//!
//! The attribute `unsafe(no_mangle)` makes a function's name that of the export; it counts as unsafe as two functions of the same
//! name would be taken for one another. Every name here begins with `live_`, which no other crate's does. Nothing else in the crate
//! is unsafe.
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

/// The bytes in the buffer.
pub(crate) fn take_bytes() -> Vec<u8> {
    TEXT.with_borrow(Clone::clone)
}

/// Puts bytes into the buffer; gives how many.
pub(crate) fn give_bytes(bytes: Vec<u8>) -> usize {
    let count = bytes.len();
    TEXT.set(bytes);
    count
}

/// The result as a number; an error's text goes into the buffer.
pub(crate) fn number(result: Result<i32>) -> i32 {
    result.unwrap_or_else(|error| {
        give(error.to_string());
        -1
    })
}

/// Makes room for a text of this many bytes; returns the address to write it to.
#[unsafe(no_mangle)]
extern "C" fn live_text_room(bytes: usize) -> *mut u8 {
    TEXT.with_borrow_mut(|text| {
        text.clear();
        text.resize(bytes, 0);
        text.as_mut_ptr()
    })
}

/// Address of the text in the buffer.
#[unsafe(no_mangle)]
extern "C" fn live_text() -> *const u8 {
    TEXT.with_borrow(|text| text.as_ptr())
}

/// Length of the text in the buffer, bytes.
#[unsafe(no_mangle)]
extern "C" fn live_text_bytes() -> usize {
    TEXT.with_borrow(Vec::len)
}

/// Opens a loop of the scene in the buffer; gives its handle, or −1.
#[unsafe(no_mangle)]
extern "C" fn live_open() -> i32 {
    number(desk(|desk| desk.open(&take())).map(|handle| handle as i32))
}

/// Closes a loop.
#[unsafe(no_mangle)]
extern "C" fn live_close(handle: usize) {
    desk(|desk| desk.close(handle));
}

/// Goes on with the scene in the buffer from where device and hand are; 0, or −1.
#[unsafe(no_mangle)]
extern "C" fn live_change(handle: usize) -> i32 {
    number(desk(|desk| desk.change(handle, &take())).map(|()| 0))
}

/// Starts again; 0, or −1.
#[unsafe(no_mangle)]
extern "C" fn live_reset(handle: usize) -> i32 {
    number(desk(|desk| desk.reset(handle)).map(|()| 0))
}

/// Runs one tick with the hand's rest point here, rad; returns the address of its row, or 0 for an unknown handle.
#[unsafe(no_mangle)]
extern "C" fn live_tick(handle: usize, rest_rad: f64) -> *const f64 {
    desk(|desk| {
        desk.tick(handle, rest_rad)
            .map_or(std::ptr::null(), |row| row.as_ptr())
    })
}

/// The scene's own rest point at a time, rad; NaN where it has none.
#[unsafe(no_mangle)]
extern "C" fn live_own_rest(handle: usize, time_s: f64) -> f64 {
    desk(|desk| desk.own_rest_rad(handle, time_s))
}

/// Address of the loop's facts, or 0 for an unknown handle.
#[unsafe(no_mangle)]
extern "C" fn live_facts(handle: usize) -> *const f64 {
    desk(|desk| {
        desk.facts(handle)
            .map_or(std::ptr::null(), |facts| facts.as_ptr())
    })
}

/// Puts the printed scene into the buffer.
#[unsafe(no_mangle)]
extern "C" fn live_printed(handle: usize) {
    give(desk(|desk| desk.printed(handle)));
}

/// Puts the scene that repeats the ticks into the buffer, in the place of the name of the file of rest points.
#[unsafe(no_mangle)]
extern "C" fn live_replay(handle: usize) {
    give(desk(|desk| desk.replay(handle, &take())));
}

/// Puts the violated bounds into the buffer, a line each.
#[unsafe(no_mangle)]
extern "C" fn live_warnings(handle: usize) {
    give(desk(|desk| desk.warnings(handle)));
}
