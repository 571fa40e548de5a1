//! The energy guard, and virtual walls that contain it, for firmware that is not written in Rust.
//!
//! [`guard`] bounds the energy of any force. [`wall`] is a whole virtual wall, from penetration to torque; [`feel`] is all that a
//! knob can have, from encoder count to torque; [`settings`] sets their settings by name. [`estimator`] is the state estimator
//! alone. [`memory`] is the only module that turns memory owned by C into a Rust value. `include/touchstone.h` is generated from
//! this crate.
#![cfg_attr(target_os = "none", no_std)]

pub mod estimator;
pub mod feel;
pub mod guard;
pub mod memory;
mod message;
pub mod parts;
pub mod settings;
pub mod status;
pub mod wall;

/// A position or displacement, rad (m) times 2^24.
#[allow(non_camel_case_types)]
pub type ts_position = i32;
/// A torque or force, N·m (N) times 2^24.
#[allow(non_camel_case_types)]
pub type ts_force = i32;
/// An energy, J times 2^48.
#[allow(non_camel_case_types)]
pub type ts_energy = i64;
/// The value of a setting in its SI unit, times 2^32. The macro `TS_SI` makes one from a constant.
#[allow(non_camel_case_types)]
pub type ts_si = i64;

/// Panic handler, which a linker needs without an operating system. It is never called, because nothing in this crate panics.
#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
