//! The enhanced law's specification tick (thesis Algorithm 3.1, Fig. 3.18; the virtual mass of §3.5 by backward Euler).

use super::{GAIN, HIGHEST, SIGNAL, signal, spring, towards_zero};

/// The coefficients, in quanta.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Enhanced {
    /// `k_de`, a gain; what is regulated towards; `k_v`.
    pub desired: i128,
    /// The stiffness that is regulated towards, a gain.
    pub target: i128,
    /// `k_v`, a gain.
    pub soft: i128,
    /// `1/k_v`, a ratio.
    pub compliance: i128,
    /// Fraction of the ideal step (3.7, 3.8), a ratio.
    pub of_ideal: i128,
    /// `b/k_v` (3.9), a ratio.
    pub of_force: i128,
    /// `a` (3.11), a ratio.
    pub of_penetration: i128,
    /// The stiffness at the HIP is regulated, not that at the mass.
    pub at_hip: bool,
    /// The offset is changed at every tick, not only while the mass moves inward.
    pub every_tick: bool,
    /// The mass' next displacement is counted, not the last.
    pub exact: bool,
    /// The force of the first contact is kept at its end (2.16, 2.17).
    pub keep_force: bool,
    /// `m/T²`, a gain.
    pub inertia: i128,
    /// `k_f`, a gain.
    pub coupling: i128,
    /// `c_f/T`, a gain.
    pub damping: i128,
    /// `m/T² + k_f + c_f/T + c_env/T`, a gain.
    pub total: i128,
    /// `k_f + k_v`, a gain.
    pub series: i128,
    /// Energy lent to each contact.
    pub credit: i128,
    /// Most that is stored.
    pub energy_cap: i128,
    /// Largest force.
    pub limit: i128,
}

/// Where the contact stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Contact {
    /// None.
    #[default]
    Free,
    /// Up to the first reversal.
    First,
    /// After it.
    Augmenting,
}

/// The memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Memory {
    /// Where the contact stands.
    pub contact: Contact,
    /// Penetration of the last tick.
    pub last: i128,
    /// Force at the HIP.
    pub force: i128,
    /// Energy left, the loan included.
    pub energy: i128,
    /// Penetration of the mass.
    pub mass: i128,
    /// Its displacement in the last tick.
    pub mass_moved: i128,
    /// `O`.
    pub offset: i128,
    /// Force of the wall on the mass.
    pub at_mass: i128,
}

/// A force outwards of a tension, rounded down; none inwards.
fn outward(tension: i128) -> i128 {
    (tension.max(0) >> GAIN).min(HIGHEST)
}

/// The same rounded up.
fn outward_up(tension: i128) -> i128 {
    ((tension.max(0) + (1 << GAIN) - 1) >> GAIN).min(HIGHEST)
}

/// A share of a signal, towards zero.
fn share(ratio: i128, x: i128) -> i128 {
    towards_zero(ratio * x, 1 << SIGNAL).clamp(-HIGHEST, HIGHEST)
}

/// The position that a tension holds in a spring, towards zero.
fn per(tension: i128, stiffness: i128) -> i128 {
    towards_zero(tension, stiffness).clamp(-HIGHEST, HIGHEST)
}

fn size(x: i128) -> i128 {
    x.abs().min(HIGHEST)
}

impl Enhanced {
    /// One tick at the penetration `e` after a displacement `moved`: memory and force.
    #[must_use]
    pub fn tick(&self, memory: &Memory, e: i128, moved: i128) -> (Memory, i128) {
        let mut m = *memory;
        if m.contact == Contact::Free && e > 0 {
            let force = outward(self.desired * e).min(self.limit);
            let (contact, energy) = (Contact::First, self.credit);
            let first = Memory {
                contact,
                energy,
                force,
                last: e,
                ..Memory::default()
            };
            return (first, force);
        }
        if m.contact == Contact::First {
            m.energy = (m.energy + m.force * moved).min(self.energy_cap);
            if moved < 0 && e > 0 {
                m = self.hand_over(&m);
            }
        }
        let force = match m.contact {
            Contact::Free => None,
            Contact::First => (e > 0).then(|| outward(self.desired * e)),
            Contact::Augmenting => self.augmented(&mut m, e, moved),
        };
        let Some(force) = force else {
            return (
                Memory {
                    last: e,
                    ..Memory::default()
                },
                0,
            );
        };
        let force = force.min(self.limit);
        (
            Memory {
                last: e,
                force,
                ..m
            },
            force,
        )
    }

    /// The first contact is over: the mass takes its place, with what is left of the energy.
    fn hand_over(&self, m: &Memory) -> Memory {
        let e = m.last;
        let (mass, offset) = if self.keep_force {
            let mass = signal(e - per(m.force << GAIN, self.coupling));
            (mass, signal(share(self.compliance, m.force) - mass).max(0))
        } else {
            (per(self.coupling * e, self.series), 0)
        };
        // Half of the coupling's force times its stretch, both rounded up; a force beyond the format is not granted.
        let stretch = size(signal(e - mass));
        let tension = self.coupling * stretch;
        let stored = (outward_up(tension) * stretch + 1) >> 1;
        let covered = tension <= HIGHEST << GAIN && stored <= m.energy;
        let (mass, energy) = if covered {
            (mass, m.energy - stored)
        } else {
            (e, m.energy.max(0))
        };
        Memory {
            contact: Contact::Augmenting,
            mass,
            mass_moved: 0,
            offset,
            energy,
            at_mass: outward(self.soft * signal(mass + offset)),
            ..*m
        }
    }

    /// Algorithm 3.1, lines 7 to 13.
    fn offset(&self, m: &Memory, e: i128) -> i128 {
        if !self.every_tick && m.mass_moved <= 0 {
            return m.offset;
        }
        let (shown, at) = if self.at_hip {
            (m.force, e)
        } else {
            (m.at_mass, m.mass)
        };
        let wanted = spring(self.target, at).min(self.limit);
        let ideal = share(self.of_ideal, size(signal(wanted - shown)));
        let weber = share(self.of_force, shown.max(1)).max(1);
        let near = share(self.of_penetration, size(at));
        let step = ideal.min(weber).min(near);
        let changed = if shown < wanted {
            m.offset + step
        } else {
            m.offset - step
        };
        signal(changed).max(0)
    }

    /// `d' = (N0 - f)/D` towards zero, and not beyond the end of positions.
    fn displacement(&self, from: i128, drive: i128, force: i128) -> i128 {
        let step = per(drive - (force << GAIN), self.total);
        signal(signal(from + step) - from)
    }

    /// The force on the HIP; `None` outside.
    fn augmented(&self, m: &mut Memory, e: i128, moved: i128) -> Option<i128> {
        m.offset = self.offset(m, e);
        let wanted = outward(self.soft * signal(m.mass + m.offset));
        if wanted == 0 {
            return None;
        }
        let before = *m;
        let drive =
            self.inertia * m.mass_moved + self.coupling * signal(e - m.mass) + self.damping * moved;
        let step;
        (m.energy, m.at_mass, step) = if self.exact {
            self.paid_move(&before, drive, wanted)
        } else {
            // Fig. 3.18: the last displacement stands for the next.
            let (energy, force) = passive(m.energy, wanted, m.mass_moved);
            let step = self.displacement(m.mass, drive, force);
            (energy.min(self.energy_cap), force, step)
        };
        (m.mass, m.mass_moved) = (signal(m.mass + step), step);
        let stretch = self.coupling * signal(e - m.mass);
        let shown = towards_zero(
            stretch + self.damping * signal(moved - m.mass_moved),
            1 << GAIN,
        );
        let shown = shown.clamp(-HIGHEST, HIGHEST);
        if shown > 0 || shown == 0 && e > 0 {
            return Some(shown);
        }
        if e <= 0 {
            return None;
        }
        // A wall does not pull: the mass goes on as if it were not coupled, if that is paid for.
        let force = if self.exact { wanted } else { m.at_mass };
        let coast = self.displacement(before.mass, self.inertia * before.mass_moved, force);
        let after = before.energy + force * coast;
        let paid = !self.exact || after >= 0;
        let step = if paid { coast } else { 0 };
        if self.exact {
            m.energy = if paid {
                after.min(self.energy_cap)
            } else {
                before.energy
            };
        }
        m.at_mass = force;
        (m.mass, m.mass_moved) = (signal(before.mass + step), step);
        Some(0)
    }

    /// Energy, force and displacement of the mass such that `E' = E + f d' >= 0`.
    fn paid_move(&self, m: &Memory, drive: i128, wanted: i128) -> (i128, i128, i128) {
        let step = self.displacement(m.mass, drive, wanted);
        let after = m.energy + wanted * step;
        if after >= 0 {
            return (after.min(self.energy_cap), wanted, step);
        }
        let retreat = m.energy / wanted;
        let force = outward_up(drive + self.total * retreat).min(wanted);
        if force == 0 {
            return (m.energy, 0, self.displacement(m.mass, drive, 0));
        }
        (m.energy - force * retreat, force, -retreat)
    }
}

/// (2.1) to (2.4): energy and force after a displacement that is known.
fn passive(energy: i128, wanted: i128, moved: i128) -> (i128, i128) {
    let force = if energy + wanted * moved >= 0 {
        wanted
    } else {
        energy / -moved
    };
    (energy + force * moved, force)
}
