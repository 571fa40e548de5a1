//! Specification tick of the time-domain passivity approach, TDPA (thesis 1.6, 2.1 to 2.6).

use super::{HIGHEST, Int, LOWEST, LOWEST_ENERGY, damping_loss, over, spring, times};

/// The law's coefficients, in quanta.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tdpa {
    /// `k_de`: stiffness that the wall should show, in the format of gains.
    pub desired: Int,
    /// Whether the law counts `f(n-1) Δe`, the port's energy, instead of `f(n) Δe` (thesis 2.1).
    pub exact: bool,
    /// `c_i/T`: damping of the device per tick (thesis 2.6), in the format of gains.
    pub device_damping: Int,
    /// Largest force, in quanta.
    pub limit: Int,
    /// Most energy that the law stores, in quanta.
    pub energy_cap: Int,
}

/// The law's memory between ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Memory {
    /// Force of the last tick.
    pub force: Int,
    /// Energy that the law's observer has summed, in quanta.
    pub energy: Int,
    /// Whether the HIP was in the wall in the last tick.
    pub inside: bool,
}

impl Tdpa {
    /// One tick at the penetration `e` after a displacement `moved`: returns memory and force.
    #[must_use]
    pub fn tick(&self, memory: &Memory, e: Int, moved: Int) -> (Memory, Int) {
        if e <= 0 {
            return (Memory::default(), 0);
        }
        let moved = moved.min(e);
        let wanted = spring(self.desired, e).min(self.limit);
        let loss = damping_loss(self.device_damping, moved);
        let (energy, force) = if self.exact {
            self.exact(memory, wanted, moved, loss)
        } else {
            let energy = (memory.energy + loss).min(self.energy_cap);
            passive(energy, wanted, moved, self.energy_cap)
        };
        (
            Memory {
                force,
                energy,
                inside: true,
            },
            force,
        )
    }

    /// Energy and force of the exact observer. `E(n) = E(n-1) + f(n-1) Δe`, and `f(n)` is such that a next displacement equal to
    /// the last one leaves no deficit.
    fn exact(&self, memory: &Memory, wanted: Int, moved: Int, loss: Int) -> (Int, Int) {
        let lowest = |energy: Int| energy.max(LOWEST_ENERGY);
        let energy =
            lowest(lowest(memory.energy + times(memory.force, moved)) + loss).min(self.energy_cap);
        let force = if moved == 0 || energy + times(wanted, moved) >= 0 {
            wanted
        } else {
            let enough = over(energy.abs(), moved.abs()).min(HIGHEST);
            if energy < 0 && moved < 0 {
                -enough
            } else {
                enough
            }
        };
        (energy, force.min(self.limit).max((-self.limit).max(LOWEST)))
    }
}

/// Energy and force of the passivity controller (thesis 2.1 to 2.4): `E(n) = E(n-1) + f(n) Δe`, at most the cap, and `f(n)` such that `E(n)` is not
/// negative.
#[must_use]
pub fn passive(energy: Int, wanted: Int, moved: Int, cap: Int) -> (Int, Int) {
    let after = energy + times(wanted, moved);
    if after >= 0 {
        return (after.min(cap), wanted);
    }
    // Outward, with too little energy: the force is the energy divided by the displacement.
    let force = over(energy, -moved);
    (energy + times(force, moved), force)
}
