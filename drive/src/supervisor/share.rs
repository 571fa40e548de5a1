//! Checks the fraction of bad encoder readings, whether or not they come in a row.
//!
//! After a bad reading the bridge is off for a control period (tick), and the energy guard takes the largest possible loss of
//! that time from its account. A few bad readings are harmless. A motor must not run on an encoder that keeps giving bad
//! readings. Each bad reading adds 50 to a sum, each good one subtracts 1, and a sum of 1,000 is a fault. So a fault takes some
//! 20 bad readings in quick succession, or lastingly more than one in 51. If every second reading is bad, the fault comes after
//! 41 readings.
//!
//! A good encoder does not reach the fault. If bad readings are independent, with the probability `p`, the sum reaches 1,000 in a
//! given period with a probability of at most `exp(-1000 r)`. Here `r` solves `p exp(50 r) + (1 - p) exp(-r) = 1`. With one bad
//! reading in a thousand the probability is `exp(-89)`.
//!
//! The first reading of a control period and the second one at the change of force have separate sums: good first readings do not
//! hide bad second ones.

use super::Found;
use touchstone_protocol::FaultCode;

const BAD: u16 = 50;
const MOST: u16 = 1_000;

/// The sums that bad readings raise and good readings lower, one for each of the two encoder readings in a control period.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Share {
    of: [u16; 2],
}

impl Share {
    /// The sums before any bad reading: zero.
    #[must_use]
    pub const fn new() -> Self {
        Self { of: [0; 2] }
    }

    /// The memory with these sums of bad first and second readings, up to 1,000 each; proofs begin with any sums.
    #[must_use]
    pub const fn from_bad_sums(sums: [u16; 2]) -> Self {
        Self { of: sums }
    }

    /// The sums of bad first and second readings, 0 to 1,000.
    #[must_use]
    pub const fn bad_sums(&self) -> [u16; 2] {
        self.of
    }

    /// Counts a control period's readings: whether the first one was bad, and whether the second was, if one was due. Returns the
    /// fault, if there is one.
    #[inline]
    pub fn update(&mut self, tick: bool, change: Option<bool>) -> Option<Found> {
        // Nearly always nothing is bad, and nothing was.
        if self.of == [0, 0] && !tick && change != Some(true) {
            return None;
        }
        self.weigh(tick, change)
    }

    #[inline(never)]
    fn weigh(&mut self, tick: bool, change: Option<bool>) -> Option<Found> {
        let mut fault = None;
        for ((left, bad), number) in self.of.iter_mut().zip([Some(tick), change]).zip(1..) {
            *left = match bad {
                Some(true) => left.saturating_add(BAD).min(MOST),
                Some(false) => left.saturating_sub(1),
                None => *left,
            };
            if *left >= MOST {
                fault = fault.or(Some((FaultCode::EncoderUnsteady, number)));
            }
        }
        fault
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Number of control periods until a fault, and the fault's number, which says which of the two readings caused it.
    fn after(ticks: u32, bad: impl Fn(u32) -> (bool, Option<bool>)) -> Option<(u32, i32)> {
        let mut share = Share::new();
        (0..ticks).find_map(|tick| {
            let (first, second) = bad(tick);
            share.update(first, second).map(|(_, value)| (tick, value))
        })
    }

    #[test]
    fn a_share_is_found_in_either_reading_and_one_in_a_hundred_is_borne() {
        assert_eq!(after(100, |t| (t % 2 == 0, Some(false))), Some((40, 1)));
        assert_eq!(after(100, |t| (false, Some(t % 2 == 0))), Some((40, 2)));
        assert_eq!(
            after(100, |t| (false, (t % 2 == 0).then_some(true))),
            Some((38, 2))
        );
        assert_eq!(
            after(100_000, |t| (t % 100 == 0, Some(t % 100 == 50))),
            None
        );
        assert!(after(100_000, |t| (t % 45 == 0, None)).is_some());
    }
}
