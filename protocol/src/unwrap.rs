//! From a counter that wraps around to a count that does not.
//!
//! A timer in encoder mode counts modulo 2^16 or 2^32. Between two samples the count moved by less than half of that, so the
//! difference of the readings, taken modulo the counter and read as a signed number, is the true movement.

macro_rules! unwrap {
    ($(#[$doc:meta])* $name:ident, $counter:ty, $signed:ty) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub struct $name {
            last: $counter,
            count: i64,
        }

        impl $name {
            /// Starts at a reading of the counter that stands for `count`.
            #[must_use]
            pub const fn new(reading: $counter, count: i64) -> Self {
                Self { last: reading, count }
            }

            /// Takes the next reading; returns the unbroken count, at the end of its range if it would leave it.
            ///
            /// Right as long as the encoder moved by at most half the counter's range since the last reading.
            #[inline]
            pub fn update(&mut self, reading: $counter) -> i64 {
                let moved = reading.wrapping_sub(self.last).cast_signed();
                self.last = reading;
                self.count = self.count.saturating_add(i64::from(moved));
                self.count
            }

            /// The last reading.
            #[inline]
            #[must_use]
            pub const fn reading(&self) -> $counter {
                self.last
            }

            /// The count at the last reading.
            #[inline]
            #[must_use]
            pub const fn count(&self) -> i64 {
                self.count
            }

            /// Whole turns (towards minus infinity) and the counts beyond them, `0 <= rest < counts_per_rev`; `None` for an
            /// encoder without counts.
            #[inline]
            #[must_use]
            pub fn turns(&self, counts_per_rev: u32) -> Option<(i64, u32)> {
                let counts = i64::from(counts_per_rev);
                let turns = self.count.checked_div_euclid(counts)?;
                // 0 <= rest < counts_per_rev, so it fits.
                let rest = self.count.checked_rem_euclid(counts)?;
                Some((turns, u32::try_from(rest).ok()?))
            }
        }
    };
}

unwrap!(
    /// Unwraps a 16-bit counter.
    Unwrap16, u16, i16
);
unwrap!(
    /// Unwraps a 32-bit counter.
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
        // One more and the way back is shorter.
        assert_eq!(count.update(32_768), -32_768);
    }

    #[test]
    fn the_end_of_the_count_holds() {
        let mut count = Unwrap32::new(0, i64::MAX - 1);
        assert_eq!(count.update(5), i64::MAX);
    }
}
