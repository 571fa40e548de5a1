//! The energy guard's specification tick, line by line that of `proofs/coq/Guard.v`, which the theorem is about.

use super::{GAIN, HIGHEST, SIGNAL};

/// The coefficients, in quanta.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Guard {
    /// `C`.
    pub capacity: i128,
    /// `P T`.
    pub refill: i128,
    /// `c`, a gain.
    pub damping: i128,
    /// The longest measured displacement that is not overspeed.
    pub furthest: i128,
    /// `δ`.
    pub count: i128,
    /// `s`, a ratio.
    pub late: i128,
    /// `κ`, a ratio.
    pub stray: i128,
    /// Half a count and what rounding leaves out.
    pub slack: i128,
    /// `1/D`, a gain.
    pub per_reach: i128,
    /// `s d` and half a count.
    pub in_flight: i128,
    /// `(1 + s)/4c`, a ratio.
    pub overrun: i128,
}

/// The memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Memory {
    /// What the hand may still get out.
    pub account: i128,
    /// The force of the last tick.
    pub force: i128,
    /// The force of the tick before it.
    pub older: i128,
}

/// `x` within `-limit..=limit`.
fn within(x: i128, limit: i128) -> i128 {
    x.min(limit).max(-limit)
}

impl Guard {
    /// What the trusted damping took over a displacement of this size.
    fn damped(&self, distance: i128) -> i128 {
        let surely = (distance - self.count).max(0);
        ((self.damping * surely) >> GAIN) * surely
    }

    /// What a force may still cost after the next sample.
    fn reserve(&self, force: i128) -> i128 {
        force.abs() * self.in_flight
    }

    /// The largest force that so much energy pays for over every displacement.
    #[must_use]
    pub fn largest_force(&self, free: i128) -> i128 {
        (self.per_reach * (free >> SIGNAL)) >> GAIN
    }

    fn booked(&self, memory: &Memory, moved: i128, before_change: i128) -> i128 {
        let change = memory.force - memory.older;
        let under_older =
            before_change + ((self.late * (moved - before_change) + self.stray * change) >> SIGNAL);
        memory.account + self.refill + memory.force * moved
            - change * under_older
            - change.abs() * self.slack
            + self.damped(moved.abs())
    }

    /// What the forces that acted can have lost at most until they are off.
    fn lost(&self, memory: &Memory) -> i128 {
        let size = memory.force.abs().max(memory.older.abs());
        let over = ((self.overrun * size) >> SIGNAL).min(HIGHEST);
        size * (over + 1).min(HIGHEST)
    }

    /// One tick, and whether it was no overspeed.
    #[must_use]
    pub fn tick(
        &self,
        memory: &Memory,
        moved: i128,
        before_change: i128,
        wanted: i128,
    ) -> (Memory, bool) {
        let still = Memory::default();
        if moved.abs() > self.furthest || before_change.abs() > self.furthest {
            let account = memory.account - self.lost(memory);
            return (Memory { account, ..still }, false);
        }
        if memory.account < 0 {
            let account = memory.account + self.refill + self.damped(moved.abs());
            let account = account.min(self.capacity);
            return (Memory { account, ..still }, true);
        }
        let reserve = self.reserve(memory.force);
        let booked = self.booked(memory, moved, before_change);
        let free = (booked.min(self.capacity) - reserve).max(0);
        let after = Memory {
            account: free + reserve,
            force: within(wanted, self.largest_force(free)),
            older: memory.force,
        };
        (after, true)
    }

    /// What is told of the force in the end.
    #[must_use]
    pub fn commanded(memory: &Memory, told: i128) -> Memory {
        Memory {
            force: within(told, memory.force.abs()),
            ..*memory
        }
    }

    /// What the theorem asks of the coefficients, for a device whose positions are wrong by at most `δ/2`, that moves at most
    /// `d` in a tick, whose forces begin to act after a share `s` of it and whose `s (1-s)/4c` is `κ`: `covers` of
    /// `proofs/coq/GuardLosesNothing.v`, times `2^`[`FINE`], each as what the left side lacks of the right. None may be negative.
    #[must_use]
    pub fn room(&self, device: &Device) -> [(&'static str, i128); 5] {
        let one = 1_i128 << FINE;
        let product = |a: i128, b: i128| -(-(a * b) >> FINE);
        let Device { s, d, delta, kappa } = *device;
        let largest = self.largest_force(self.capacity);
        let half = (delta + 1) >> 1;
        let ratio = |stored: i128| stored << (FINE - SIGNAL);
        let rest = product(one - s, d);
        let slack = half
            + one
            + (s - ratio(self.late)).abs() * self.furthest
            + (kappa - ratio(self.stray)).max(0) * 2 * largest;
        let reach = rest + self.in_flight * one + half;
        [
            ("count", self.count * one - delta),
            ("in flight", self.in_flight * one - product(s, d) - half),
            ("reach", (one << (GAIN + SIGNAL)) - self.per_reach * reach),
            ("slack", self.slack * one - slack),
            (
                "not negative",
                self.overrun
                    .min(self.per_reach)
                    .min(self.damping)
                    .min(self.refill)
                    .min(self.capacity),
            ),
        ]
    }
}

/// Fractional bits below a quantum that [`Device`] has.
pub const FINE: u32 = 40;

/// The device of the theorem: `s` and `κ` as numbers, `d` and `δ` in quanta, all with [`FINE`] fractional bits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Device {
    /// Share of a tick after which a force begins to act.
    pub s: i128,
    /// The furthest that it moves in a tick.
    pub d: i128,
    /// Twice the largest error of a measured position.
    pub delta: i128,
    /// `s (1-s)/4c`, or more.
    pub kappa: i128,
}
