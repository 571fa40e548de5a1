//! The peripherals of the chip, as far as the firmware uses them.
//!
//! Times are in cycles of the processor's clock. No operation completes at once: a model that sets its flags immediately would hide
//! race conditions in code that waits for the flags.

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

/// Time that stands for an event that will not happen.
pub const NEVER: u64 = u64::MAX;

/// Clock frequency of processor, buses and timers in hertz, as the firmware configures it. The simulated world uses this clock from
/// the start; the real chip is slower until the PLL runs.
pub const CORE_HZ: u64 = 170_000_000;

/// Processor cycles per microsecond at the clock that the firmware sets up, for durations that no clock divider in the modelled
/// registers changes.
pub const CYCLES_PER_US: u64 = 170;

/// A peripheral: a block of registers with its behaviour in time.
pub trait Peripheral {
    /// Reads the register at byte `offset`, a multiple of four.
    fn read(&mut self, offset: u32, now: u64) -> u32;
    /// Writes the register at byte `offset`.
    fn write(&mut self, offset: u32, value: u32, now: u64);
    /// Time in processor cycles of the next event of the peripheral.
    fn next_event(&self) -> u64 {
        NEVER
    }
    /// Carries out the events of the peripheral that are due.
    fn advance(&mut self, _now: u64) {}
    /// Active interrupt lines of the peripheral: bit n stands for interrupt number n.
    fn lines(&self) -> u128 {
        0
    }
}

/// Clears and sets bits of a register: `(old & !clear) | set`.
pub(crate) fn change(register: &mut u32, set: u32, clear: u32) {
    *register = (*register & !clear) | set;
}
