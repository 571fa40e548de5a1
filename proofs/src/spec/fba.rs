//! FBA's specification tick (thesis 2.6a to 2.10).

use super::{GAIN, HIGHEST, damping_loss, spring, towards_zero};

/// The coefficients, in quanta.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fba {
    /// `k_de`, a gain.
    pub desired: i128,
    /// `c_i/T`, a gain.
    pub device_damping: i128,
    /// `sqrt(4 c_i/T)`, a gain.
    pub bound: i128,
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

/// `floor(sqrt(x))`, 0 for what is negative: by halving an interval, unlike the code.
#[must_use]
pub fn root(x: i128) -> i128 {
    let (mut low, mut high) = (0, 1_i128 << 62);
    if x <= 0 {
        return 0;
    }
    while high - low > 1 {
        let middle = i128::midpoint(low, high);
        if middle * middle <= x {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

impl Fba {
    /// `sqrt(4 c_i/T)`, rounded down.
    #[must_use]
    pub fn bound_of(device_damping: i128) -> i128 {
        root((4 * device_damping) << GAIN)
    }

    /// One tick at the penetration `e` after a displacement `moved`: memory and force.
    #[must_use]
    pub fn tick(&self, memory: &Memory, e: i128, moved: i128) -> (Memory, i128) {
        if e <= 0 {
            return (Memory::default(), 0);
        }
        let moved = moved.min(e);
        // (2.6a), and (2.10) for what may be shown of the force that the spring wants.
        let energy =
            memory.energy + memory.force * moved + damping_loss(self.device_damping, moved);
        let energy = energy.min(self.energy_cap);
        let wanted = spring(self.desired, e).min(self.limit);
        let allowed = towards_zero(self.bound * root(energy).min(HIGHEST), 1 << GAIN).min(HIGHEST);
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
