//! Specification ticks of the spring (thesis 1.6, §1.2.6) and of successive force augmentation (thesis 2.11 to 2.17, 3.2, 3.3).

use super::{GAIN, HIGHEST, Int, SIGNAL, cut, signal, spring, times};

/// `f = k_de e + (b/T) Δe`, never pulling, zero outside; coefficients in quanta.
#[must_use]
pub fn spring_tick(desired: Int, damping: Int, limit: Int, e: Int, moved: Int) -> Int {
    if e <= 0 {
        return 0;
    }
    let tension = times(desired, e) + times(damping, moved.min(e));
    cut(tension, GAIN).clamp(0, HIGHEST.min(limit))
}

/// The moments at which the offset is changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Update {
    /// The offset changes when the motion turns inward (2.14).
    TurnInward,
    /// The offset changes while the motion goes inward (3.2).
    Inward,
    /// Always.
    EveryTick,
}

/// The coefficients, in quanta.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sfa {
    /// `k_de`, a gain.
    pub desired: Int,
    /// `k_v`, a gain.
    pub soft: Int,
    /// `k_c/k_v - 1` (2.14a), a ratio.
    pub gain: Int,
    /// `1/k_v`, a ratio.
    pub compliance: Int,
    /// The moments at which the offset is changed.
    pub update: Update,
    /// The force of the first contact is kept at its end (2.16, 2.17).
    pub keep_force: bool,
    /// Largest force.
    pub limit: Int,
}

/// The memory; `augmenting` is after the first reversal, `inside` from the first tick in the wall on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Memory {
    /// Whether there is contact.
    pub inside: bool,
    /// Whether the first reversal has passed.
    pub augmenting: bool,
    /// Penetration of the last tick.
    pub last: Int,
    /// Penetration of the tick before the last.
    pub before_last: Int,
    /// Offset: `O`.
    pub offset: Int,
    /// Force of the last tick.
    pub force: Int,
}

impl Sfa {
    /// (2.14) and (3.2): the step of the offset.
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
        // What the limit takes away again is no reason for an offset.
        let wanted = spring(self.desired, m.last).min(self.limit);
        match (m.last > 0, m.force.cmp(&wanted)) {
            (true, std::cmp::Ordering::Less) => step,
            (true, std::cmp::Ordering::Equal) => 0,
            _ => -step,
        }
    }

    /// One tick at the penetration `e` after a displacement `moved`: memory and force.
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
