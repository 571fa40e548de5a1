//! Specification ticks of the spring (thesis 1.6, §1.2.6) and of successive force augmentation (thesis 2.11 to 2.17, 3.2, 3.3).

use super::{GAIN, HIGHEST, SIGNAL, signal, spring, towards_zero};

/// `f = k_de e + (b/T) Δe`, never pulling, zero outside; coefficients in quanta.
#[must_use]
pub fn spring_tick(desired: i128, damping: i128, limit: i128, e: i128, moved: i128) -> i128 {
    if e <= 0 {
        return 0;
    }
    let tension = desired * e + damping * moved.min(e);
    towards_zero(tension, 1 << GAIN).clamp(0, HIGHEST.min(limit))
}

/// When the offset is changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Update {
    /// When the motion turns inward (2.14).
    TurnInward,
    /// While it goes inward (3.2).
    Inward,
    /// Always.
    EveryTick,
}

/// The coefficients, in quanta.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sfa {
    /// `k_de`, a gain.
    pub desired: i128,
    /// `k_v`, a gain.
    pub soft: i128,
    /// `k_c/k_v - 1` (2.14a), a ratio.
    pub gain: i128,
    /// `1/k_v`, a ratio.
    pub compliance: i128,
    /// When the offset is changed.
    pub update: Update,
    /// The force of the first contact is kept at its end (2.16, 2.17).
    pub keep_force: bool,
    /// Largest force.
    pub limit: i128,
}

/// The memory; `augmenting` is after the first reversal, `inside` from the first tick in the wall on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Memory {
    /// In contact.
    pub inside: bool,
    /// After the first reversal.
    pub augmenting: bool,
    /// Penetration of the last tick.
    pub last: i128,
    /// That of the tick before it.
    pub before_last: i128,
    /// `O`.
    pub offset: i128,
    /// Force of the last tick.
    pub force: i128,
}

impl Sfa {
    /// (2.14) and (3.2): the step of the offset.
    fn step(&self, m: &Memory, moved: i128) -> i128 {
        let due = match self.update {
            Update::TurnInward => moved > 0 && m.last <= m.before_last,
            Update::Inward => moved > 0,
            Update::EveryTick => true,
        };
        if !due {
            return 0;
        }
        let step = towards_zero(self.gain * moved, 1 << SIGNAL).clamp(-HIGHEST, HIGHEST);
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
    pub fn tick(&self, memory: &Memory, e: i128, moved: i128) -> (Memory, i128) {
        let m = memory;
        let turned = m.inside && !m.augmenting && moved < 0;
        let offset = if turned && self.keep_force {
            // (2.16), (2.17)
            let force = spring(self.desired, e).clamp(0, self.limit);
            let held = towards_zero(self.compliance * force, 1 << SIGNAL).clamp(-HIGHEST, HIGHEST);
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
