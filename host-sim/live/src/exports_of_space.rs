//! WebAssembly functions for the page of the simulated device with three axes. Texts go through the buffer of [`crate::exports`].
//! What that module says about `unsafe` applies here too.
#![allow(unsafe_code)]

use crate::exports::{give, number, take};
use crate::space_loop::{SpaceChoice, SpaceLoop};
use std::cell::RefCell;

thread_local! {
    static SPACE: RefCell<Option<SpaceLoop>> = const { RefCell::new(None) };
}

/// Opens the simulated loop of three axes with the settings in the shared text buffer. Returns 0, or −1 after an error.
#[unsafe(no_mangle)]
extern "C" fn live_space_open() -> i32 {
    let opened = SpaceChoice::of_text(&take()).and_then(SpaceLoop::new);
    number(opened.map(|space| {
        SPACE.set(Some(space));
        0
    }))
}

/// Changes the settings of the running loop to those in the shared text buffer; device and hand keep their positions. Returns 0, or
/// −1 after an error.
#[unsafe(no_mangle)]
extern "C" fn live_space_change() -> i32 {
    let choice = SpaceChoice::of_text(&take());
    number(choice.and_then(|choice| {
        SPACE.with_borrow_mut(|space| match space {
            Some(space) => space.change(choice).map(|()| 0),
            None => Ok(0),
        })
    }))
}

/// Runs one control period with the rest point of the hand's spring at this position, in mm. Returns the address of the row of
/// numbers, or 0 if no loop is open.
#[unsafe(no_mangle)]
extern "C" fn live_space_tick(x_mm: f64, y_mm: f64, z_mm: f64) -> *const f64 {
    SPACE.with_borrow_mut(|space| {
        space.as_mut().map_or(std::ptr::null(), |space| {
            space.tick([x_mm, y_mm, z_mm]).as_ptr()
        })
    })
}

/// Puts the values of the loop that change only with its settings into the shared text buffer, as JSON.
#[unsafe(no_mangle)]
extern "C" fn live_space_facts() {
    give(SPACE.with_borrow(|space| space.as_ref().map_or_else(String::new, SpaceLoop::facts)));
}
