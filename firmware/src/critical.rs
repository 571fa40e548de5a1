//! The critical section of embassy and defmt. It masks the interrupts of priorities 3 and below. The current loop, the timer's
//! break and the control interrupt (priorities 0 to 2) still run.
//!
//! Interrupts of priorities 0 to 2 share only atomics with the rest of the program and never enter a critical section. `cargo xtask
//! firmware` checks the latter in the compiled program. So a long critical section, such as a log message, does not delay these
//! interrupts.

use core::sync::atomic::{Ordering, compiler_fence};

use cortex_m::register::{basepri, basepri_max};

/// The highest masked priority, 3, in the processor's encoding: the upper four of eight bits.
const FIRST_MASKED: u8 = 3 << 4;

struct Masking;

critical_section::set_impl!(Masking);

// SAFETY: there is one core. Code in the thread or at priority 3 or below excludes all other such code by raising BASEPRI. Nested
// sections restore the earlier value. Code at priorities 0 to 2 never enters a critical section (`cargo xtask firmware` checks
// this).
unsafe impl critical_section::Impl for Masking {
    unsafe fn acquire() -> critical_section::RawRestoreState {
        let before = basepri::read();
        basepri_max::write(FIRST_MASKED);
        // The barrier makes the write take effect before the next instruction; cortex-m does the same for PRIMASK.
        cortex_m::asm::isb();
        compiler_fence(Ordering::SeqCst);
        before
    }

    unsafe fn release(before: critical_section::RawRestoreState) {
        compiler_fence(Ordering::SeqCst);
        // SAFETY: `before` is the value that `acquire` has read, so this only restores it.
        unsafe { basepri::write(before) };
    }
}
