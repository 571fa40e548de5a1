//! Specification of a tick of the force bounding approach, FBA (thesis 2.6a to 2.10).

use super::{BITS, GAIN, HIGHEST, Int, cut, damping_loss, spring, times};

/// The coefficients of force bounding, as integers in steps of their number formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fba {
    /// Desired stiffness of the wall, in the number format of stiffnesses.
    pub desired: Int,
    /// Damping of the device divided by the control period, in the number format of stiffnesses.
    pub device_damping: Int,
    /// Factor of the bound on the force: root of four times the device's damping per tick, in the number format of stiffnesses.
    pub bound: Int,
    /// Largest force, in steps of the force format.
    pub limit: Int,
    /// Most energy that the law stores, in steps of the energy format.
    pub energy_cap: Int,
}

/// The force bounding law's memory between ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Memory {
    /// Force of the last tick.
    pub force: Int,
    /// Energy that the law has summed, in steps of the energy format.
    pub energy: Int,
    /// Whether the hand's point (HIP) was in the wall in the last tick.
    pub inside: bool,
}

/// Square root rounded down, at most the highest position or force plus 1; 0 for a negative `x`. This function halves an interval,
/// while the code calculates digit by digit.
#[must_use]
pub fn root(x: Int) -> Int {
    let (mut low, mut high) = (0, HIGHEST + 2);
    if x <= 0 {
        return 0;
    }
    for _ in 0..=BITS {
        let middle = (low + high) / 2;
        if times(middle, middle) <= x {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

impl Fba {
    /// The factor of the force bound for a device's damping per tick: root of four times the damping, rounded down.
    #[must_use]
    pub fn bound_of(device_damping: Int) -> Int {
        root((4 * device_damping) << GAIN)
    }

    /// One tick at the penetration `e` after a displacement `moved`: returns the new memory and the force.
    #[must_use]
    pub fn tick(&self, memory: &Memory, e: Int, moved: Int) -> (Memory, Int) {
        if e <= 0 {
            return (Memory::default(), 0);
        }
        let moved = moved.min(e);
        // (2.6a); then (2.10) for the part of the spring's force that is allowed.
        let energy =
            memory.energy + times(memory.force, moved) + damping_loss(self.device_damping, moved);
        let energy = energy.min(self.energy_cap);
        let wanted = spring(self.desired, e).min(self.limit);
        let allowed = cut(times(self.bound, root(energy).min(HIGHEST)), GAIN).min(HIGHEST);
        let force = wanted.min(allowed);
        (
            Memory {
                force,
                energy,
                inside: true,
            },
            force,
        )
    }
}
