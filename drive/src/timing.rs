//! Cycles and lateness of each stage: least, most, mean.

/// What the firmware measured of a control tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TickTiming {
    /// Cycles from the moment that the tick was due to its first instruction.
    pub lateness: u32,
    /// Cycles of the tick before, from its first instruction to its last; 0 in the first.
    pub duration: u32,
}

/// A running summary of cycles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cycles {
    least: u32,
    most: u32,
    sum: u64,
    count: u32,
}

impl Default for Cycles {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl Cycles {
    /// Nothing yet.
    pub const EMPTY: Self = Self {
        least: u32::MAX,
        most: 0,
        sum: 0,
        count: 0,
    };

    /// Adds one. Starts anew after 2^32 - 1 of them: 59 hours at 20 kHz.
    #[inline]
    pub fn add(&mut self, cycles: u32) {
        if self.count == u32::MAX {
            *self = Self::EMPTY;
        }
        self.least = self.least.min(cycles);
        self.most = self.most.max(cycles);
        // Below 2^32 times 2^32.
        self.sum = self.sum.wrapping_add(u64::from(cycles));
        self.count = self.count.wrapping_add(1);
    }

    /// The fewest; 0 without any.
    #[must_use]
    pub const fn least(&self) -> u32 {
        if self.count == 0 { 0 } else { self.least }
    }

    /// The most.
    #[must_use]
    pub const fn most(&self) -> u32 {
        self.most
    }

    /// The mean, rounded down; 0 without any. Divides: not for an interrupt.
    #[must_use]
    pub fn mean(&self) -> u32 {
        let mean = self.sum.checked_div(u64::from(self.count)).unwrap_or(0);
        u32::try_from(mean).unwrap_or(u32::MAX)
    }

    /// How many.
    #[must_use]
    pub const fn count(&self) -> u32 {
        self.count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn least_most_mean() {
        let mut cycles = Cycles::EMPTY;
        assert_eq!((cycles.least(), cycles.most(), cycles.mean()), (0, 0, 0));
        for value in [5, 1, 9, 6] {
            cycles.add(value);
        }
        assert_eq!(
            (cycles.least(), cycles.most(), cycles.mean(), cycles.count()),
            (1, 9, 5, 4)
        );
        let mut full = Cycles {
            count: u32::MAX,
            sum: u64::MAX,
            ..cycles
        };
        full.add(3);
        assert_eq!(
            (full.least(), full.most(), full.mean(), full.count()),
            (3, 3, 3, 1)
        );
    }
}
