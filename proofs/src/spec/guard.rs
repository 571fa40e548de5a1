//! The energy guard's specification tick, line by line that of `proofs/coq/Guard.v`, which the theorem is about.

use super::{GAIN, HIGHEST, Int, SIGNAL, times};

/// The coefficients, in quanta.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Guard {
    /// Capacity: `C`.
    pub capacity: Int,
    /// Refill: `P T`.
    pub refill: Int,
    /// `c`, a gain.
    pub damping: Int,
    /// The longest measured displacement that is not overspeed.
    pub furthest: Int,
    /// Count: `δ`.
    pub count: Int,
    /// `s`, a ratio.
    pub late: Int,
    /// `κ`, a ratio.
    pub stray: Int,
    /// Half a count and what rounding leaves out.
    pub slack: Int,
    /// `1/D`, a gain.
    pub per_reach: Int,
    /// `s d` and half a count.
    pub in_flight: Int,
    /// `(1 + s)/4c`, a ratio.
    pub overrun: Int,
}

/// The memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Memory {
    /// Energy that the hand may still get out.
    pub account: Int,
    /// The force of the last tick.
    pub force: Int,
    /// The force of the tick before it.
    pub older: Int,
}

/// `x` within `-limit..=limit`.
fn within(x: Int, limit: Int) -> Int {
    x.min(limit).max(-limit)
}

impl Guard {
    /// Energy that the trusted damping took over a displacement of this size.
    fn damped(&self, distance: Int) -> Int {
        let surely = (distance - self.count).max(0);
        times(times(self.damping, surely) >> GAIN, surely)
    }

    /// The most that a force may still cost after the next sample.
    fn reserve(&self, force: Int) -> Int {
        times(force.abs(), self.in_flight)
    }

    /// The largest force that an energy pays for over every displacement.
    #[must_use]
    pub fn largest_force(&self, free: Int) -> Int {
        times(self.per_reach, free >> SIGNAL) >> GAIN
    }

    /// The account after a tick.
    #[must_use]
    pub fn booked(&self, memory: &Memory, moved: Int, before_change: Int) -> Int {
        let change = memory.force - memory.older;
        let under_older = before_change
            + ((times(self.late, moved - before_change) + times(self.stray, change)) >> SIGNAL);
        memory.account + self.refill + times(memory.force, moved)
            - times(change, under_older)
            - times(change.abs(), self.slack)
            + self.damped(moved.abs())
    }

    /// The most that the forces that acted can have lost until they are off.
    fn lost(&self, memory: &Memory) -> Int {
        let size = memory.force.abs().max(memory.older.abs());
        let over = (times(self.overrun, size) >> SIGNAL).min(HIGHEST);
        times(size, (over + 1).min(HIGHEST))
    }

    /// One tick; with whether there was no overspeed.
    #[must_use]
    pub fn tick(
        &self,
        memory: &Memory,
        moved: Int,
        before_change: Int,
        wanted: Int,
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

    /// Switched off: the account less what the older force may still cost; or, after a force that no tick ended, at
    /// most nothing.
    #[must_use]
    pub fn switched_off(&self, memory: &Memory) -> Memory {
        Memory {
            account: if memory.force == 0 {
                memory.account - self.reserve(memory.older)
            } else {
                memory.account.min(0)
            },
            ..Memory::default()
        }
    }

    /// Takes the force that was commanded in the end.
    #[must_use]
    pub fn commanded(memory: &Memory, told: Int) -> Memory {
        Memory {
            force: within(told, memory.force.abs()),
            ..*memory
        }
    }
}
