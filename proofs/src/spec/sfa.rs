//! Specification ticks of the spring (thesis 1.6, §1.2.6) and of successive force augmentation, SFA (thesis 2.11 to 2.17, 3.2,
//! 3.3).

use super::{GAIN, HIGHEST, Int, SIGNAL, cut, signal, spring, times};

/// The spring law `f = k_de e + (b/T) Δe`. The force never pulls inward and is 0 outside the wall; coefficients are in quanta.
#[must_use]
pub fn spring_tick(desired: Int, damping: Int, limit: Int, e: Int, moved: Int) -> Int {
    if e <= 0 {
        return 0;
    }
    let tension = times(desired, e) + times(damping, moved.min(e));
    cut(tension, GAIN).clamp(0, HIGHEST.min(limit))
}

/// The moments at which the offset of the wall's surface changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Update {
    /// The offset changes when the motion turns inward (thesis 2.14).
    TurnInward,
    /// The offset changes while the motion goes inward (thesis 3.2).
    Inward,
    /// The offset changes at every tick.
    EveryTick,
}

/// The law's coefficients, in quanta.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sfa {
    /// `k_de`: stiffness that the wall should show, in the format of gains.
    pub desired: Int,
    /// `k_v`: stiffness of the virtual spring, in the format of gains.
    pub soft: Int,
    /// `k_c/k_v - 1`: step of the offset per displacement (thesis 2.14a), in the format of ratios.
    pub gain: Int,
    /// `1/k_v`: compliance of the virtual spring, in the format of ratios.
    pub compliance: Int,
    /// The moments at which the offset of the wall's surface changes.
    pub update: Update,
    /// Whether the force is kept where the first contact phase ends (thesis 2.16, 2.17).
    pub keep_force: bool,
    /// Largest force, in quanta.
    pub limit: Int,
}

/// The law's memory between ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Memory {
    /// Whether the HIP is in contact, from the first tick inside the wall on.
    pub inside: bool,
    /// Whether the motion has reversed once since the contact began.
    pub augmenting: bool,
    /// Penetration of the last tick.
    pub last: Int,
    /// Penetration of the tick before the last.
    pub before_last: Int,
    /// `O`: offset of the wall's surface.
    pub offset: Int,
    /// Force of the last tick.
    pub force: Int,
}

impl Sfa {
    /// Step of the offset in a tick (thesis 2.14 and 3.2).
    fn step(&self, m: &Memory, moved: Int) -> Int {
        let due = match self.update {
            Update::TurnInward => moved > 0 && m.last <= m.before_last,
            Update::Inward => moved > 0,
            Update::EveryTick => true,
        };
        if !due {
            return 0;
        }
        let step = cut(times(self.gain, moved), SIGNAL).clamp(-HIGHEST, HIGHEST);
        // A force that the limit cuts off is no reason to move the offset.
        let wanted = spring(self.desired, m.last).min(self.limit);
        match (m.last > 0, m.force.cmp(&wanted)) {
            (true, std::cmp::Ordering::Less) => step,
            (true, std::cmp::Ordering::Equal) => 0,
            _ => -step,
        }
    }

    /// One tick at the penetration `e` after a displacement `moved`: returns memory and force.
    #[must_use]
    pub fn tick(&self, memory: &Memory, e: Int, moved: Int) -> (Memory, Int) {
        let m = memory;
        let turned = m.inside && !m.augmenting && moved < 0;
        let offset = if turned && self.keep_force {
            // (2.16), (2.17)
            let force = spring(self.desired, e).clamp(0, self.limit);
            let held = cut(times(self.compliance, force), SIGNAL).clamp(-HIGHEST, HIGHEST);
            signal(held - e)
        } else if m.augmenting {
            signal(m.offset + self.step(m, moved))
        } else {
            0
        };
        let inside = m.inside || e > 0;
        let augmenting = m.augmenting || turned;
        let force = if augmenting {
            spring(self.soft, signal(e + offset))
        } else if inside {
            spring(self.desired, e)
        } else {
            0
        };
        let force = force.min(self.limit);
        let (last, before_last) = (e, m.last);
        if force <= 0 {
            return (
                Memory {
                    last,
                    before_last,
                    ..Memory::default()
                },
                0,
            );
        }
        (
            Memory {
                inside,
                augmenting,
                last,
                before_last,
                offset,
                force,
            },
            force,
        )
    }
}
