//! Counts executed instructions by a clock of the emulator.
//!
//! QEMU's `-icount shift=10` lets every instruction take 1024 ns, and the board's SysTick counts steps of 40 ns. That is 25.6 steps
//! per instruction, so the difference of two readings gives the number of instructions exactly. A real microcontroller's clock
//! counts cycles instead.

use core::arch::asm;
use core::fmt;
use core::hint::black_box;

use cortex_m::Peripherals;
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;

const FULL: u32 = 0x00ff_ffff;
const NS_PER_COUNT: u32 = 40;
const NS_PER_INSTRUCTION: u32 = 1024;

/// The running clock, by which instructions are counted.
#[derive(Clone, Copy)]
pub struct Ruler;

impl Ruler {
    /// Starts the clock; returns `None` if it does not count instructions.
    pub fn take() -> Option<Self> {
        let mut clock = Peripherals::take()?.SYST;
        clock.set_clock_source(SystClkSource::Core);
        clock.set_reload(FULL);
        clock.clear_current();
        clock.enable_counter();
        // SAFETY: `nop` does nothing.
        let nops = || unsafe { asm!(".rept 1000", "nop", ".endr") };
        let (_, counted) = Self.count(nops);
        // The compiler may add an instruction or two between the readings, but must not remove any.
        (1000..=1003).contains(&counted).then_some(Self)
    }

    /// Runs a function; returns its result and the instructions between the two readings of the clock, at most 650,000. The count
    /// includes passing the arguments, the call and the return.
    #[inline(always)]
    pub fn count<T>(self, something: impl FnOnce() -> T) -> (T, u32) {
        let before = SYST::get_current();
        let result = black_box(something());
        let after = SYST::get_current();
        // SysTick counts down, in 24 bits.
        let ns = (before.wrapping_sub(after) & FULL) * NS_PER_COUNT;
        let instructions = (ns + NS_PER_INSTRUCTION / 2) / NS_PER_INSTRUCTION;
        // One of the counted instructions reads the clock.
        (result, instructions.saturating_sub(1))
    }
}

/// Mean and largest number of instructions of many measured calls.
#[derive(Default)]
pub struct Tally {
    runs: u32,
    sum: u64,
    worst: u32,
}

impl Tally {
    /// Adds the number of instructions of one measured call.
    pub fn add(&mut self, instructions: u32) {
        self.runs += 1;
        self.sum += u64::from(instructions);
        self.worst = self.worst.max(instructions);
    }
}

impl fmt::Display for Tally {
    /// Writes the number of measured calls, the sum of their instructions, and the largest number.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {} {}", self.runs, self.sum, self.worst)
    }
}
