//! Specification tick of the energy guard. Line by line it is the tick of `proofs/coq/Guard.v`, which the guard's theorem is about.

use super::{GAIN, HIGHEST, Int, SIGNAL, times};

/// The guard's coefficients, in quanta.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Guard {
    /// `C`: most energy that the account holds.
    pub capacity: Int,
    /// `P T`: energy added to the account per tick.
    pub refill: Int,
    /// `c`: trusted damping per tick, in the format of gains.
    pub damping: Int,
    /// The largest measured displacement in a tick that is not over-speed.
    pub furthest: Int,
    /// `δ`: encoder count, twice the largest error of a measured position.
    pub count: Int,
    /// `s`: fraction of a tick after which a force acts, in the format of ratios.
    pub late: Int,
    /// `κ`: energy charged per squared change of force, in the format of ratios.
    pub stray: Int,
    /// Half an encoder count plus a bound of the rounding errors.
    pub slack: Int,
    /// `1/D`: largest force per free energy, in the format of gains.
    pub per_reach: Int,
    /// `s d` plus half an encoder count: displacement for which a force in flight still costs energy.
    pub in_flight: Int,
    /// `(1 + s)/4c`: energy charged at an over-speed per squared force, in the format of ratios.
    pub overrun: Int,
}

/// The guard's memory between ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Memory {
    /// Energy account: what the hand may still get out.
    pub account: Int,
    /// Force of the last tick.
    pub force: Int,
    /// Force of the tick before the last.
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

    /// Most energy that a force may still cost after the next sample.
    fn reserve(&self, force: Int) -> Int {
        times(force.abs(), self.in_flight)
    }

    /// The largest force that a free energy covers for every allowed displacement.
    #[must_use]
    pub fn largest_force(&self, free: Int) -> Int {
        times(self.per_reach, free >> SIGNAL) >> GAIN
    }

    /// Energy account after a tick, before it is limited to its capacity.
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

    /// Most energy that the hand can have gained from the acting forces until they are off.
    fn lost(&self, memory: &Memory) -> Int {
        let size = memory.force.abs().max(memory.older.abs());
        let over = (times(self.overrun, size) >> SIGNAL).min(HIGHEST);
        times(size, (over + 1).min(HIGHEST))
    }

    /// One tick. Returns the memory, and `true` if there was no over-speed.
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

    /// The memory after the force was switched off. If a tick has ended the force, the account is reduced by what the older force
    /// may still cost. Otherwise the account becomes at most 0.
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

    /// The memory after a report of the force that was commanded in the end.
    #[must_use]
    pub fn commanded(memory: &Memory, told: Int) -> Memory {
        Memory {
            force: within(told, memory.force.abs()),
            ..*memory
        }
    }
}
