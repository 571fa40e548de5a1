//! TDPA's specification tick (thesis 1.6, 2.1 to 2.6).

use super::{HIGHEST, LOWEST, damping_loss, spring};

/// The coefficients, in quanta.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tdpa {
    /// `k_de`, a gain.
    pub desired: i128,
    /// `f(n-1) Δe` (the port's energy) if true, `f(n) Δe` (thesis 2.1) if not.
    pub exact: bool,
    /// `c_i/T`, a gain (2.6).
    pub device_damping: i128,
    /// Largest force.
    pub limit: i128,
    /// Most that is stored.
    pub energy_cap: i128,
}

/// The memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Memory {
    /// Force of the last tick.
    pub force: i128,
    /// Observed energy.
    pub energy: i128,
    /// Whether the HIP was in the wall.
    pub inside: bool,
}

/// The lowest energy of the format: a deficit of 32 kJ is cut off there.
const LOWEST_ENERGY: i128 = -(1 << 63);

impl Tdpa {
    /// One tick at the penetration `e` after a displacement `moved`: memory and force.
    #[must_use]
    pub fn tick(&self, memory: &Memory, e: i128, moved: i128) -> (Memory, i128) {
        if e <= 0 {
            return (Memory::default(), 0);
        }
        let moved = moved.min(e);
        let wanted = spring(self.desired, e).min(self.limit);
        let loss = damping_loss(self.device_damping, moved);
        let (energy, force) = if self.exact {
            self.exact(memory, wanted, moved, loss)
        } else {
            self.thesis(memory, wanted, moved, loss)
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

    /// (2.1) to (2.4): `E(n) = E(n-1) + f(n) Δe`, and `f(n)` such that it is not negative.
    fn thesis(&self, memory: &Memory, wanted: i128, moved: i128, loss: i128) -> (i128, i128) {
        let energy = (memory.energy + loss).min(self.energy_cap);
        let force = if energy + wanted * moved >= 0 {
            wanted
        } else {
            // Outward, and not enough in store: what there is, over the displacement.
            energy / -moved
        };
        ((energy + force * moved).min(self.energy_cap), force)
    }

    /// `E(n) = E(n-1) + f(n-1) Δe`, and `f(n)` such that the next displacement, taken to be like the last, leaves no deficit.
    fn exact(&self, memory: &Memory, wanted: i128, moved: i128, loss: i128) -> (i128, i128) {
        let lowest = |energy: i128| energy.max(LOWEST_ENERGY);
        let energy =
            lowest(lowest(memory.energy + memory.force * moved) + loss).min(self.energy_cap);
        let force = if moved == 0 || energy + wanted * moved >= 0 {
            wanted
        } else {
            let enough = (energy.abs() / moved.abs()).min(HIGHEST);
            if energy < 0 && moved < 0 {
                -enough
            } else {
                enough
            }
        };
        (energy, force.min(self.limit).max((-self.limit).max(LOWEST)))
    }
}
