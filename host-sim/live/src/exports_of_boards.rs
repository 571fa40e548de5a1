//! Functions for a page that holds a board's port: bytes in, bytes out, messages and rows for the page.
//!
//! Bytes and texts go through the buffer of [`crate::exports`], whose words about `unsafe` hold here too.
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

/// Begins anew; the buffer holds the port's name for messages.
#[unsafe(no_mangle)]
extern "C" fn live_board_new() {
    TALK.set(Talk::new(&take()));
}

/// The port is open.
#[unsafe(no_mangle)]
extern "C" fn live_board_opened(now_ms: f64) {
    talk(|talk| talk.opened(now_ms));
}

/// The port is gone; why, is in the buffer.
#[unsafe(no_mangle)]
extern "C" fn live_board_closed() {
    talk(|talk| talk.closed(&take()));
}

/// Takes the bytes in the buffer, which came in.
#[unsafe(no_mangle)]
extern "C" fn live_board_take(now_ms: f64) {
    talk(|talk| talk.take(&take_bytes(), now_ms));
}

/// Carries out the order in the buffer.
#[unsafe(no_mangle)]
extern "C" fn live_board_order(now_ms: f64) {
    talk(|talk| talk.order(&take(), now_ms));
}

/// Tells the module the time.
#[unsafe(no_mangle)]
extern "C" fn live_board_turn(now_ms: f64) {
    talk(|talk| talk.turn(now_ms));
}

/// Puts the bytes to be sent into the buffer; returns how many.
#[unsafe(no_mangle)]
extern "C" fn live_board_out() -> usize {
    give_bytes(talk(Talk::out))
}

/// Puts the next message into the buffer; 0 if there is none.
#[unsafe(no_mangle)]
extern "C" fn live_board_said() -> i32 {
    talk(Talk::said).map_or(0, |message| {
        give(message);
        1
    })
}

/// Takes the rows that came since the last call; returns their count of numbers.
#[unsafe(no_mangle)]
extern "C" fn live_board_rows() -> usize {
    let rows = talk(Talk::rows);
    let count = rows.len();
    ROWS.set(rows);
    count
}

/// Address of the numbers of these rows.
#[unsafe(no_mangle)]
extern "C" fn live_board_numbers() -> *const f64 {
    ROWS.with_borrow(|rows| rows.as_ptr())
}
