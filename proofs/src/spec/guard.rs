//! Specification of a tick of the energy guard. It follows line by line `proofs/coq/Guard.v`, the subject of the guard's theorem.

use super::{GAIN, HIGHEST, Int, SIGNAL, times};

/// The guard's coefficients, as integers in steps of their number formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Guard {
    /// Capacity: most energy that the account holds.
    pub capacity: Int,
    /// Energy that the refill power adds to the account per tick.
    pub refill: Int,
    /// Trusted damping divided by the control period, in the number format of stiffnesses.
    pub damping: Int,
    /// The largest measured displacement in a tick that is not overspeed.
    pub furthest: Int,
    /// Twice the largest error of a measured position (one encoder count).
    pub count: Int,
    /// Fraction of a tick after which a force begins to act, in the number format of ratios.
    pub late: Int,
    /// Energy charged per squared change of force, in the number format of ratios.
    pub stray: Int,
    /// Distance charged per change of force: half an encoder count plus a bound of the rounding errors.
    pub slack: Int,
    /// Largest force for each unit of free energy, in the number format of stiffnesses: 1 over the sum of the largest displacement
    /// and a count.
    pub per_reach: Int,
    /// Largest displacement for which the present force may act after the next sample, plus half an encoder count.
    pub in_flight: Int,
    /// Energy charged at overspeed per squared force, in the number format of ratios.
    pub overrun: Int,
}

/// The energy guard's memory between ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Memory {
    /// Energy account: the energy that the hand may still get out.
    pub account: Int,
    /// Force of the last tick.
    pub force: Int,
    /// Force of the tick before the last one.
    pub older: Int,
}

/// A number limited to the range from `-limit` to `limit`.
fn within(x: Int, limit: Int) -> Int {
    x.min(limit).max(-limit)
}

impl Guard {
    /// Energy that the trusted damping dissipated over a displacement of this size.
    fn damped(&self, distance: Int) -> Int {
        let surely = (distance - self.count).max(0);
        times(times(self.damping, surely) >> GAIN, surely)
    }

    /// Most energy that a force may still cost after the next sample (the reserve).
    fn reserve(&self, force: Int) -> Int {
        times(force.abs(), self.in_flight)
    }

    /// The largest force that the free energy in the account covers for every allowed displacement.
    #[must_use]
    pub fn largest_force(&self, free: Int) -> Int {
        times(self.per_reach, free >> SIGNAL) >> GAIN
    }

    /// Energy in the account after a tick, before it is limited to the most that the account holds.
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

    /// Most energy that the hand can have gained, at overspeed, from the acting forces until they end.
    fn lost(&self, memory: &Memory) -> Int {
        let size = memory.force.abs().max(memory.older.abs());
        let over = (times(self.overrun, size) >> SIGNAL).min(HIGHEST);
        times(size, (over + 1).min(HIGHEST))
    }

    /// One tick of the guard. Returns the new memory, and `true` if there was no overspeed.
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

    /// The guard's memory after the force was switched off. If the last tick commanded no force, the account is reduced by what the
    /// older force may still cost. Otherwise the account becomes at most 0.
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

    /// The guard's memory after a report of the force that was finally commanded.
    #[must_use]
    pub fn commanded(memory: &Memory, told: Int) -> Memory {
        Memory {
            force: within(told, memory.force.abs()),
            ..*memory
        }
    }
}
