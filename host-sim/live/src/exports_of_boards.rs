//! WebAssembly functions for a page that holds the serial port of a board. The page passes in the received bytes. The functions
//! return the bytes to send, messages, and rows of numbers to draw.
//!
//! Bytes and texts go through the buffer of [`crate::exports`]. What that module says about `unsafe` applies here too.
#![allow(unsafe_code)]

use crate::exports::{give, give_bytes, take, take_bytes};
use std::cell::RefCell;
use touchstone_link::talk::Talk;

thread_local! {
    static TALK: RefCell<Talk> = RefCell::new(Talk::new("device"));
    static ROWS: RefCell<Vec<f64>> = const { RefCell::new(Vec::new()) };
}

fn talk<T>(with: impl FnOnce(&mut Talk) -> T) -> T {
    TALK.with_borrow_mut(with)
}

/// Starts a new connection to a board. The shared text buffer holds the port's name for messages.
#[unsafe(no_mangle)]
extern "C" fn live_board_new() {
    TALK.set(Talk::new(&take()));
}

/// The page calls this function when it has opened the serial port.
#[unsafe(no_mangle)]
extern "C" fn live_board_opened(now_ms: f64) {
    talk(|talk| talk.opened(now_ms));
}

/// The page calls this function when the serial port is gone. The shared text buffer holds the reason.
#[unsafe(no_mangle)]
extern "C" fn live_board_closed() {
    talk(|talk| talk.closed(&take()));
}

/// Processes bytes that the page received from the board and put into the shared buffer.
#[unsafe(no_mangle)]
extern "C" fn live_board_take(now_ms: f64) {
    talk(|talk| talk.take(&take_bytes(), now_ms));
}

/// Carries out a command of the page to the board. The command is JSON in the shared text buffer.
#[unsafe(no_mangle)]
extern "C" fn live_board_order(now_ms: f64) {
    talk(|talk| talk.order(&take(), now_ms));
}

/// Does what is due at the time `now_ms`, such as repeating an unanswered request. The page calls it some fifty times a second.
#[unsafe(no_mangle)]
extern "C" fn live_board_turn(now_ms: f64) {
    talk(|talk| talk.turn(now_ms));
}

/// Puts the bytes to send to the board into the shared buffer; returns how many.
#[unsafe(no_mangle)]
extern "C" fn live_board_out() -> usize {
    give_bytes(talk(Talk::out))
}

/// Puts the next message for the page into the shared text buffer; returns 0 if there is none.
#[unsafe(no_mangle)]
extern "C" fn live_board_said() -> i32 {
    talk(Talk::said).map_or(0, |message| {
        give(message);
        1
    })
}

/// Collects the rows of all telemetry records since the last call; returns how many numbers the rows hold together.
#[unsafe(no_mangle)]
extern "C" fn live_board_rows() -> usize {
    let rows = talk(Talk::rows);
    let count = rows.len();
    ROWS.set(rows);
    count
}

/// Address of the numbers that the last call of `live_board_rows` collected.
#[unsafe(no_mangle)]
extern "C" fn live_board_numbers() -> *const f64 {
    ROWS.with_borrow(|rows| rows.as_ptr())
}
