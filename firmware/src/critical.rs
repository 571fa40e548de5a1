//! What embassy and defmt call a critical section: everything from priority 3 downwards waits, the current loop, the break and
//! the control tick do not.
//!
//! Those three (priorities 0 to 2) share only atomics with the rest and never enter a critical section, which
//! `cargo xtask firmware` checks on the program. So a long one, such as a line of the log, costs them nothing.

use core::sync::atomic::{Ordering, compiler_fence};

use cortex_m::register::{basepri, basepri_max};

/// The first priority that waits, as the processor writes it: the upper four of eight bits.
const FIRST_MASKED: u8 = 3 << 4;

struct Masking;

critical_section::set_impl!(Masking);

// SAFETY: on the one core, code that runs at priority 3 or below, or in the thread, excludes all other such code by raising
// BASEPRI, and nesting restores what was. Code at priorities 0 to 2 never takes a critical section (checked on the program).
unsafe impl critical_section::Impl for Masking {
    unsafe fn acquire() -> critical_section::RawRestoreState {
        let before = basepri::read();
        basepri_max::write(FIRST_MASKED);
        // As cortex-m does for PRIMASK: the write takes effect before what follows.
        cortex_m::asm::isb();
        compiler_fence(Ordering::SeqCst);
        before
    }

    unsafe fn release(before: critical_section::RawRestoreState) {
        compiler_fence(Ordering::SeqCst);
        // SAFETY: `before` is what `acquire` found, so this only undoes it.
        unsafe { basepri::write(before) };
    }
}
