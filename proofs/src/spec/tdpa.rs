//! Specification of a tick of the time-domain passivity approach, TDPA (thesis 1.6, 2.1 to 2.6).

use super::{HIGHEST, Int, LOWEST, LOWEST_ENERGY, damping_loss, over, spring, times};

/// The coefficients of time-domain passivity control, as integers in steps of their number formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tdpa {
    /// Desired stiffness of the wall, in the number format of stiffnesses.
    pub desired: Int,
    /// Whether the law counts the true energy, last force times displacement, instead of new force times displacement (thesis 2.1).
    pub exact: bool,
    /// Damping of the device divided by the control period (thesis 2.6), in the number format of stiffnesses.
    pub device_damping: Int,
    /// Largest force, in steps of the force format.
    pub limit: Int,
    /// Most energy that the law stores, in steps of the energy format.
    pub energy_cap: Int,
}

/// The memory of time-domain passivity control between ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Memory {
    /// Force of the last tick.
    pub force: Int,
    /// Energy that the law's observer has summed, in steps of the energy format.
    pub energy: Int,
    /// Whether the hand's point (HIP) was in the wall in the last tick.
    pub inside: bool,
}

impl Tdpa {
    /// One tick at the penetration `e` after a displacement `moved`: returns the new memory and the force.
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

    /// Energy and force with the exact observer. The energy grows by last force times displacement. The new force is such that a
    /// next displacement equal to the last one leaves no deficit.
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

/// Energy and force of the thesis' passivity controller (2.1 to 2.4). The energy grows by new force times displacement, up to the
/// cap, and the force is such that the energy does not become negative.
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
