//! The energy guard, and the walls behind it, for firmware that is not written in Rust.
//!
//! [`guard`] bounds any force, [`wall`] is a whole wall from count to torque, [`settings`] are its settings by name, [`memory`] is the one place where
//! memory that C owns becomes a Rust value. `include/touchstone.h` is made of this crate.
#![cfg_attr(target_os = "none", no_std)]

pub mod guard;
pub mod memory;
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
/// The value of a setting in its SI unit, times 2^32.
#[allow(non_camel_case_types)]
pub type ts_si = i64;

/// Never called, as nothing here panics; but a linker without an operating system needs a handler.
#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
