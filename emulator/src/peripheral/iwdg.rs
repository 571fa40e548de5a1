//! The independent watchdog. Its oscillator's frequency can be set within the limits of the data sheet.

use super::{CYCLES_PER_US, NEVER, Peripheral};

/// The independent watchdog.
#[derive(Debug, Clone)]
pub struct Iwdg {
    lsi_hz: u64,
    prescaler: u32,
    reload: u32,
    unlocked: bool,
    /// Time in processor cycles at which the watchdog will reset the chip; [`NEVER`] while it is not started.
    bites: u64,
    /// Time in processor cycles until which a register write is still being transferred to the oscillator's clock domain.
    busy: u64,
    /// Longest time between two refreshes so far, in processor cycles.
    pub longest: u64,
    fed: u64,
}

impl Iwdg {
    /// A stopped watchdog whose oscillator runs at `lsi_hz`: nominally 32 kHz, at the limits 29.5 and 34 kHz.
    #[must_use]
    pub fn new(lsi_hz: u64) -> Self {
        Self {
            lsi_hz,
            prescaler: 0,
            reload: 0xfff,
            unlocked: false,
            bites: NEVER,
            busy: 0,
            longest: 0,
            fed: NEVER,
        }
    }

    fn time_out(&self) -> u64 {
        let counts = u64::from(self.reload) + 1;
        let cycles = counts * (4 << self.prescaler.min(6));
        cycles * 1_000_000 * CYCLES_PER_US / self.lsi_hz
    }

    fn feed(&mut self, now: u64) {
        if self.fed != NEVER {
            self.longest = self.longest.max(now - self.fed);
        }
        self.fed = now;
        if self.bites != NEVER {
            self.bites = now + self.time_out();
        }
    }

    /// Whether the watchdog has to reset the chip at the time `now`, in processor cycles.
    #[must_use]
    pub fn bites(&self, now: u64) -> bool {
        now >= self.bites
    }

    /// Whether the program has started the watchdog.
    #[must_use]
    pub fn is_started(&self) -> bool {
        self.bites != NEVER
    }
}

impl Peripheral for Iwdg {
    fn read(&mut self, offset: u32, now: u64) -> u32 {
        match offset {
            0x04 => self.prescaler,
            0x08 => self.reload,
            0x0c => u32::from(now < self.busy) * 3,
            0x10 => 0xfff,
            _ => 0,
        }
    }

    fn write(&mut self, offset: u32, value: u32, now: u64) {
        match (offset, value & 0xffff) {
            (0x00, 0x5555) => self.unlocked = true,
            (0x00, 0xaaaa) => {
                self.unlocked = false;
                self.feed(now);
            }
            (0x00, 0xcccc) => {
                self.bites = now + self.time_out();
                self.fed = now;
            }
            (0x04, value) if self.unlocked => {
                self.prescaler = value & 7;
                self.busy = now + 5 * 1_000_000 * CYCLES_PER_US / self.lsi_hz;
            }
            (0x08, value) if self.unlocked => {
                self.reload = value & 0xfff;
                self.busy = now + 5 * 1_000_000 * CYCLES_PER_US / self.lsi_hz;
            }
            _ => {}
        }
    }

    fn next_event(&self) -> u64 {
        self.bites
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bites_after_its_time_unless_fed() {
        let mut dog = Iwdg::new(32_000);
        dog.write(0x00, 0xcccc, 0);
        dog.write(0x00, 0x5555, 0);
        dog.write(0x04, 2, 0);
        dog.write(0x08, 199, 0);
        dog.write(0x00, 0xaaaa, 0);
        // 200 counts of 16 cycles of 31.25 us: 100 ms.
        let time = 100_000 * CYCLES_PER_US;
        assert!(!dog.bites(time - 1) && dog.bites(time));
        dog.write(0x00, 0xaaaa, time - 1);
        assert!(!dog.bites(time) && dog.bites(2 * time - 1));
        assert_eq!(dog.longest, time - 1);
    }
}
