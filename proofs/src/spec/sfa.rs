//! Specification of a tick of the spring (thesis 1.6, §1.2.6) and of successive force augmentation, SFA (thesis 2.11 to 2.17, 3.2,
//! 3.3).

use super::{GAIN, HIGHEST, Int, SIGNAL, cut, signal, spring, times};

/// The spring law: stiffness times penetration plus damping per tick times displacement. The force never pulls inward and is 0
/// outside the wall; coefficients are integers in steps of their formats.
#[must_use]
pub fn spring_tick(desired: Int, damping: Int, limit: Int, e: Int, moved: Int) -> Int {
    if e <= 0 {
        return 0;
    }
    let tension = times(desired, e) + times(damping, moved.min(e));
    cut(tension, GAIN).clamp(0, HIGHEST.min(limit))
}

/// The ticks in which the offset of the soft spring changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Update {
    /// In the tick in which the motion turns inward (thesis 2.14).
    TurnInward,
    /// In every tick in which the motion goes inward (thesis 3.2).
    Inward,
    /// In every tick of contact.
    EveryTick,
}

/// The coefficients of successive force augmentation, as integers in steps of their number formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sfa {
    /// Desired stiffness of the wall, in the number format of stiffnesses.
    pub desired: Int,
    /// Stiffness of the soft virtual spring, in the number format of stiffnesses.
    pub soft: Int,
    /// Step of the offset per displacement: critical stiffness divided by the soft one, minus 1 (thesis 2.14a), in the number
    /// format of ratios.
    pub gain: Int,
    /// Compliance of the soft virtual spring, in the number format of ratios.
    pub compliance: Int,
    /// The ticks in which the offset of the soft spring changes.
    pub update: Update,
    /// Whether the force stays the same at the end of the contact's first phase (thesis 2.16, 2.17); otherwise the offset starts at
    /// zero.
    pub keep_force: bool,
    /// Largest force, in steps of the force format.
    pub limit: Int,
}

/// The memory of successive force augmentation between ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Memory {
    /// Whether there is contact, from the first tick inside the wall on.
    pub inside: bool,
    /// Whether the motion has reversed once since the contact began.
    pub augmenting: bool,
    /// Penetration of the last tick.
    pub last: Int,
    /// Penetration of the tick before the last one.
    pub before_last: Int,
    /// Offset: deformation of the soft spring beyond the penetration.
    pub offset: Int,
    /// Force of the last tick.
    pub force: Int,
}

impl Sfa {
    /// Step of the soft spring's offset in a tick (thesis 2.14 and 3.2).
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
        // The offset does not move to make up for force beyond the limit.
        let wanted = spring(self.desired, m.last).min(self.limit);
        match (m.last > 0, m.force.cmp(&wanted)) {
            (true, std::cmp::Ordering::Less) => step,
            (true, std::cmp::Ordering::Equal) => 0,
            _ => -step,
        }
    }

    /// One tick at the penetration `e` after a displacement `moved`: returns the new memory and the force.
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
