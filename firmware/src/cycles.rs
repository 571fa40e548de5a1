//! The processor's cycle counter.

use cortex_m::peripheral::DWT;

/// Starts the cycle counter.
pub fn start(core: &mut cortex_m::Peripherals) {
    core.DCB.enable_trace();
    core.DWT.enable_cycle_counter();
}

/// The value of the processor's cycle counter; it wraps after 25 s.
#[inline(always)]
pub fn now() -> u32 {
    DWT::cycle_count()
}
