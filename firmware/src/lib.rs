//! Touchstone's program for microcontrollers: access to registers, and the connections between its parts.
//!
//! The program makes no decisions. An interrupt reads registers into a plain struct and calls one function of `touchstone-drive`.
//! It writes the returned struct to registers. `docs/firmware.md` says which interrupt may do what.
#![no_std]

// The log goes to a debug probe; without one it is dropped.
use defmt_rtt as _;

#[cfg(not(any(
    feature = "nucleo-g474re",
    feature = "nucleo-g474re-ihm16m1",
    feature = "nucleo-g474re-simplefoc-mini",
    feature = "nucleo-g431rb-ihm16m1",
    feature = "b-g431b-esc1"
)))]
compile_error!("which board? --no-default-features --features <board>");

// If two boards were selected, this module would be defined twice and the build would fail.
#[cfg(feature = "b-g431b-esc1")]
#[path = "board/b_g431b_esc1.rs"]
pub mod board;
#[cfg(feature = "nucleo-g431rb-ihm16m1")]
#[path = "board/nucleo_g431rb_ihm16m1.rs"]
pub mod board;
#[cfg(feature = "nucleo-g474re")]
#[path = "board/nucleo_g474re.rs"]
pub mod board;
#[cfg(feature = "nucleo-g474re-ihm16m1")]
#[path = "board/nucleo_g474re_ihm16m1.rs"]
pub mod board;
#[cfg(feature = "nucleo-g474re-simplefoc-mini")]
#[path = "board/nucleo_g474re_simplefoc_mini.rs"]
pub mod board;

pub mod analogue;
#[cfg(feature = "g474re")]
pub mod autostart;
pub mod clock;
pub mod control;
mod copy;
pub mod crash;
pub mod critical;
pub mod cycles;
pub mod encoder;
pub mod exchange;
#[cfg(feature = "g474re")]
mod fast;
pub mod interrupts;
#[cfg(not(feature = "b-g431b-esc1"))]
pub mod magnetic;
pub mod pwm;
pub mod requests;
pub mod run;
pub mod sense;
pub mod serial;
mod serial_port;
pub mod shared;
pub mod storage;
pub mod supply;
#[cfg(feature = "g474re")]
pub mod surround;
pub mod watchdog;
pub mod window;
