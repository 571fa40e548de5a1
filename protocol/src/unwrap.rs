//! Turns the readings of a counter that wraps around into an unbroken count.
//!
//! A timer in encoder mode counts modulo 2^16 or 2^32. The encoder must move by less than half of that range between two readings.
//! Then the difference of the readings, modulo the counter's range and read as a signed number, is the true movement.

macro_rules! unwrap {
    ($(#[$doc:meta])* $name:ident, $counter:ty, $signed:ty) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub struct $name {
            last: $counter,
            count: i64,
        }

        impl $name {
            /// Starts with a first reading of the counter, which is given the unbroken count `count`.
            #[must_use]
            pub const fn new(reading: $counter, count: i64) -> Self {
                Self { last: reading, count }
            }

            /// Takes the next reading of the counter and returns the unbroken count, which saturates at the ends of `i64`.
            ///
            /// The result is right if the encoder moved by less than half the counter's range since the last reading.
            #[inline]
            pub fn update(&mut self, reading: $counter) -> i64 {
                let moved = reading.wrapping_sub(self.last).cast_signed();
                self.last = reading;
                self.count = self.count.saturating_add(i64::from(moved));
                self.count
            }

            /// The last reading of the counter.
            #[inline]
            #[must_use]
            pub const fn reading(&self) -> $counter {
                self.last
            }

            /// The unbroken count at the last reading.
            #[inline]
            #[must_use]
            pub const fn count(&self) -> i64 {
                self.count
            }

            /// Whole turns (rounded towards minus infinity) and the remaining counts, `0 <= rest < counts_per_rev`; `None` if
            /// `counts_per_rev` is 0.
            #[inline]
            #[must_use]
            pub fn turns(&self, counts_per_rev: u32) -> Option<(i64, u32)> {
                let counts = i64::from(counts_per_rev);
                let turns = self.count.checked_div_euclid(counts)?;
                // 0 <= rest < counts_per_rev, so the rest fits into 32 bits.
                let rest = self.count.checked_rem_euclid(counts)?;
                Some((turns, u32::try_from(rest).ok()?))
            }
        }
    };
}

unwrap!(
    /// Makes an unbroken count from a 16-bit counter that wraps.
    Unwrap16, u16, i16
);
unwrap!(
    /// Makes an unbroken count from a 32-bit counter that wraps.
    Unwrap32, u32, i32
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_back_and_forth_through_the_wrap() {
        let mut count = Unwrap16::new(65_530, 0);
        assert_eq!(count.update(4), 10);
        assert_eq!(count.update(65_526), -4);
        assert_eq!(count.turns(4_000), Some((-1, 3_996)));
        assert_eq!(count.turns(0), None);
    }

    #[test]
    fn half_the_range_is_the_limit() {
        let mut count = Unwrap16::new(0, 0);
        assert_eq!(count.update(32_767), 32_767);
        let mut count = Unwrap16::new(0, 0);
        // A movement by half the range reads as a movement in the other direction.
        assert_eq!(count.update(32_768), -32_768);
    }

    #[test]
    fn the_end_of_the_count_holds() {
        let mut count = Unwrap32::new(0, i64::MAX - 1);
        assert_eq!(count.update(5), i64::MAX);
    }
}
