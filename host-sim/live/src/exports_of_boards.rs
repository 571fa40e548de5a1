//! WebAssembly functions for a page that holds the serial port of a board. They take the bytes that came in, and give the bytes to
//! send, messages and rows of numbers.
//!
//! Bytes and texts go through the buffer of [`crate::exports`]. What that module says about `unsafe` holds here too.
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

/// Starts a new conversation with a board; the buffer holds the name of the port for messages.
#[unsafe(no_mangle)]
extern "C" fn live_board_new() {
    TALK.set(Talk::new(&take()));
}

/// The page reports that it has opened the port.
#[unsafe(no_mangle)]
extern "C" fn live_board_opened(now_ms: f64) {
    talk(|talk| talk.opened(now_ms));
}

/// The page reports that the port is gone; the buffer holds the reason.
#[unsafe(no_mangle)]
extern "C" fn live_board_closed() {
    talk(|talk| talk.closed(&take()));
}

/// Processes the bytes in the buffer, which the page received from the board.
#[unsafe(no_mangle)]
extern "C" fn live_board_take(now_ms: f64) {
    talk(|talk| talk.take(&take_bytes(), now_ms));
}

/// Carries out the page's order, whose text is in the buffer.
#[unsafe(no_mangle)]
extern "C" fn live_board_order(now_ms: f64) {
    talk(|talk| talk.order(&take(), now_ms));
}

/// Gives the module the present time, in milliseconds.
#[unsafe(no_mangle)]
extern "C" fn live_board_turn(now_ms: f64) {
    talk(|talk| talk.turn(now_ms));
}

/// Puts the bytes to be sent to the board into the buffer; returns their number.
#[unsafe(no_mangle)]
extern "C" fn live_board_out() -> usize {
    give_bytes(talk(Talk::out))
}

/// Puts the next message for the page into the buffer; returns 0 if there is none.
#[unsafe(no_mangle)]
extern "C" fn live_board_said() -> i32 {
    talk(Talk::said).map_or(0, |message| {
        give(message);
        1
    })
}

/// Collects the rows received since the last call; returns how many numbers they hold together.
#[unsafe(no_mangle)]
extern "C" fn live_board_rows() -> usize {
    let rows = talk(Talk::rows);
    let count = rows.len();
    ROWS.set(rows);
    count
}

/// Address of the numbers that `live_board_rows` collected last.
#[unsafe(no_mangle)]
extern "C" fn live_board_numbers() -> *const f64 {
    ROWS.with_borrow(|rows| rows.as_ptr())
}
