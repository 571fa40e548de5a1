//! Replacement of the keyboard on other systems than Linux, and without the feature `uinput`.

use crate::{KeyPair, Keyboard, OPTION};
use touchstone_sim::error::{Error, Result};

/// Opens nothing and returns an error.
///
/// # Errors
/// Always: the error says what to do instead.
pub fn open(_keys: &KeyPair) -> Result<Box<dyn Keyboard>> {
    let (problem, fix) = if cfg!(target_os = "linux") {
        (
            "this program was built without the feature for key presses",
            "build it with `--features keys`, as in `cargo run --release --features keys`; or write a program that reads --json or --websocket and presses keys",
        )
    } else {
        (
            "this program can press keys on Linux only",
            "write a program that reads --json or --websocket and presses keys",
        )
    };
    Err(Error::Option {
        option: OPTION.into(),
        problem: problem.into(),
        fix: fix.into(),
    })
}
