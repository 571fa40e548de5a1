//! The chip around the processor, as far as the firmware uses it.
//!
//! Times are in cycles of the processor's clock. Nothing completes at once: a model that sets its flags immediately
//! would hide the races of code that waits for them.

pub mod adc;
pub mod encoder;
pub mod exti;
pub mod flash;
pub mod gpio;
pub mod iwdg;
pub mod plain;
pub mod rcc;
pub mod spi;
pub mod timer;
pub mod uart;
pub mod wwdg;

/// No event ahead.
pub const NEVER: u64 = u64::MAX;

/// Clock of processor, buses and timers, Hz, as the firmware sets it up. Times of the world follow from it; before the
/// PLL runs, the chip is slower than modelled.
pub const CORE_HZ: u64 = 170_000_000;

/// Cycles of the processor's clock in a microsecond, at the clock that the firmware sets up. For times that are not
/// derived from a clock in the models' registers.
pub const CYCLES_PER_US: u64 = 170;

/// A block of registers.
pub trait Peripheral {
    /// Reads the register at `offset`, a multiple of four.
    fn read(&mut self, offset: u32, now: u64) -> u32;
    /// Writes the register at `offset`.
    fn write(&mut self, offset: u32, value: u32, now: u64);
    /// Time of the block's next event.
    fn next_event(&self) -> u64 {
        NEVER
    }
    /// Carries out what is due.
    fn advance(&mut self, _now: u64) {}
    /// The interrupt lines that are active, as bits by interrupt number.
    fn lines(&self) -> u128 {
        0
    }
}

/// Bits of a register, changed as `(old & !clear) | set`.
pub(crate) fn change(register: &mut u32, set: u32, clear: u32) {
    *register = (*register & !clear) | set;
}
