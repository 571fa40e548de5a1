//! The window watchdog (RM0440, chapter 43). Its counter counts down at the bus clock divided by 4096 and by a power of two. The
//! watchdog resets the chip when the counter falls below 0x40, or when the program writes the counter while it is above the window
//! value.

use super::{CORE_HZ, NEVER, Peripheral};

const CR: u32 = 0x00;
const CFR: u32 = 0x04;
const SR: u32 = 0x08;
const WDGA: u32 = 1 << 7;
/// Bit 6 of the counter. The chip is reset when this bit is cleared.
const T6: u32 = 0x40;

/// The window watchdog.
#[derive(Debug, Clone)]
pub struct Wwdg {
    /// Clock frequency of the watchdog's bus in hertz; 0 while the bus clock is off.
    clock_hz: u64,
    configuration: u32,
    active: bool,
    /// Value of the watchdog's counter when its clock divider had made `at` counts.
    counter: u32,
    at: u64,
    /// Whether the program wrote the counter too early, or with a value that resets the chip.
    refused: bool,
}

impl Default for Wwdg {
    fn default() -> Self {
        Self {
            clock_hz: 0,
            configuration: 0x7f,
            active: false,
            counter: 0x7f,
            at: 0,
            refused: false,
        }
    }
}

impl Wwdg {
    /// Processor cycles per count of the watchdog; the largest number while the bus clock is off.
    fn count_cycles(&self) -> u64 {
        let share = 4_096 << (self.configuration >> 11 & 7);
        (share * CORE_HZ)
            .checked_div(self.clock_hz)
            .unwrap_or(NEVER)
    }

    fn counter(&self, now: u64) -> u32 {
        let counts = (now / self.count_cycles()).saturating_sub(self.at);
        self.counter
            .saturating_sub(u32::try_from(counts).unwrap_or(u32::MAX))
    }

    /// Sets the watchdog's counter at the time `now`.
    fn set(&mut self, counter: u32, now: u64) {
        self.counter = counter;
        self.at = now / self.count_cycles();
    }

    /// Sets the clock frequency of the watchdog's bus in hertz; 0 means off. The counter keeps its value.
    pub fn set_clock(&mut self, hz: u64, now: u64) {
        if hz != self.clock_hz {
            let counter = self.counter(now);
            self.clock_hz = hz;
            self.set(counter, now);
        }
    }

    /// Time in processor cycles at which the counter falls below 0x40.
    fn falls(&self) -> u64 {
        let counts = u64::from(self.counter.saturating_sub(T6 - 1));
        (self.at + counts).saturating_mul(self.count_cycles())
    }

    /// Whether the watchdog has to reset the chip at the time `now`, in processor cycles.
    #[must_use]
    pub fn bites(&self, now: u64) -> bool {
        self.refused || now >= self.next_event()
    }
}

impl Peripheral for Wwdg {
    fn read(&mut self, offset: u32, now: u64) -> u32 {
        match offset {
            CR => self.counter(now) | u32::from(self.active) << 7,
            CFR => self.configuration,
            // The flag of the early wake-up interrupt.
            SR => u32::from(self.counter(now) <= T6),
            _ => 0,
        }
    }

    fn write(&mut self, offset: u32, value: u32, now: u64) {
        match offset {
            // Without the bus clock a write has no effect.
            _ if self.clock_hz == 0 => {}
            CR => {
                let early = self.counter(now) > self.configuration & 0x7f;
                self.refused |= self.active && early;
                // Only a reset clears this bit.
                self.active |= value & WDGA != 0;
                self.refused |= self.active && value & T6 == 0;
                self.set(value & 0x7f, now);
            }
            CFR => {
                let counter = self.counter(now);
                self.configuration = value & 0x3a7f;
                self.set(counter, now);
            }
            _ => {}
        }
    }

    fn next_event(&self) -> u64 {
        match (self.active && self.clock_hz != 0, self.refused) {
            (true, true) => 0,
            (true, false) => self.falls(),
            (false, _) => NEVER,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A watchdog that is 10 counts above 0x40 and whose bus runs at the processor's clock. `share` is the code of the clock
    /// divider in CFR.
    fn started(share: u32, now: u64) -> Wwdg {
        let mut dog = Wwdg::default();
        dog.set_clock(CORE_HZ, 0);
        dog.write(CFR, 0x7f | share << 11, now);
        dog.write(CR, WDGA | T6 | 10, now);
        dog
    }

    #[test]
    fn bites_after_its_counts_unless_refreshed() {
        // The watchdog was started half a count after the last count of its clock divider.
        let mut dog = started(0, 2_048);
        let time = 11 * 4_096;
        assert_eq!(dog.next_event(), time);
        assert!(!dog.bites(time - 1) && dog.bites(time));
        assert_eq!(dog.read(CR, time - 1), WDGA | T6);
        dog.write(CR, WDGA | T6 | 10, time - 1);
        assert!(!dog.bites(time) && dog.bites(time + 10 * 4_096));
        // The watchdog cannot be stopped.
        dog.write(CR, 0x7f, time);
        assert!(dog.bites(time + 64 * 4_096));
    }

    #[test]
    fn a_larger_share_counts_as_much_more_slowly() {
        let mut dog = started(0, 0);
        dog.write(CFR, 0x7f | 7 << 11, 5 * 4_096);
        assert_eq!(dog.read(CR, 5 * 4_096) & 0x7f, T6 + 5);
        assert_eq!(dog.next_event(), 6 * 128 * 4_096);
        dog.set_clock(CORE_HZ / 2, 5 * 4_096);
        assert_eq!(dog.next_event(), 6 * 256 * 4_096);
    }

    #[test]
    fn the_closed_window_and_a_counter_without_its_bit_reset() {
        let mut dog = started(0, 0);
        dog.write(CFR, 0x45, 0);
        dog.write(CR, WDGA | T6 | 10, 4_096);
        assert!(dog.bites(4_096));
        let mut dog = started(0, 0);
        dog.write(CR, WDGA | 0x3f, 1);
        assert!(dog.bites(1));
    }

    #[test]
    fn without_a_clock_nothing_counts() {
        let mut dog = Wwdg::default();
        dog.write(CR, WDGA | T6, 0);
        assert_eq!((dog.next_event(), dog.read(CR, 1 << 40)), (NEVER, 0x7f));
    }
}
