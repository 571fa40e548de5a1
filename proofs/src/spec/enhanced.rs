//! The enhanced law's specification tick (thesis Algorithm 3.1, Fig. 3.18; the virtual mass of §3.5 by backward Euler).

use super::tdpa::passive;
use super::{GAIN, HIGHEST, Int, SIGNAL, cut, over, signal, spring, times, towards_zero};

/// The coefficients, in quanta.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Enhanced {
    /// `k_de`, a gain; the stiffness that is regulated to; `k_v`.
    pub desired: Int,
    /// The stiffness that is regulated towards, a gain.
    pub target: Int,
    /// `B/T` of the damper beside the wall, a gain.
    pub damper: Int,
    /// `k_v`, a gain.
    pub soft: Int,
    /// `1/k_v`, a ratio.
    pub compliance: Int,
    /// Fraction of the ideal step (3.7, 3.8), a ratio.
    pub of_ideal: Int,
    /// `b/k_v` (3.9), a ratio.
    pub of_force: Int,
    /// `a` (3.11), a ratio.
    pub of_penetration: Int,
    /// The stiffness at the HIP is regulated, not that at the mass.
    pub at_hip: bool,
    /// The offset is changed at every tick, not only while the mass moves inward.
    pub every_tick: bool,
    /// The mass' next displacement is counted, not the last.
    pub exact: bool,
    /// The force of the first contact is kept at its end (2.16, 2.17).
    pub keep_force: bool,
    /// `m/T²`, a gain.
    pub inertia: Int,
    /// `k_f`, a gain.
    pub coupling: Int,
    /// `c_f/T`, a gain.
    pub damping: Int,
    /// `m/T² + k_f + c_f/T + c_env/T`, a gain.
    pub total: Int,
    /// `k_f + k_v`, a gain.
    pub series: Int,
    /// Energy lent to each contact.
    pub credit: Int,
    /// Most that is stored.
    pub energy_cap: Int,
    /// Largest force.
    pub limit: Int,
}

/// Phase of the contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Contact {
    /// No contact.
    #[default]
    Free,
    /// The phase up to the first reversal.
    First,
    /// The phase after the first reversal.
    Augmenting,
}

/// The memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Memory {
    /// Phase of the contact.
    pub contact: Contact,
    /// Penetration of the last tick.
    pub last: Int,
    /// Force of the wall at the HIP, without the damper beside it.
    pub force: Int,
    /// Energy left, the loan included.
    pub energy: Int,
    /// Penetration of the mass.
    pub mass: Int,
    /// Displacement of the mass in the last tick.
    pub mass_moved: Int,
    /// Offset: `O`.
    pub offset: Int,
    /// Force of the wall on the mass.
    pub at_mass: Int,
}

/// A force outwards of a tension, rounded down; none inwards.
fn outward(tension: Int) -> Int {
    (tension.max(0) >> GAIN).min(HIGHEST)
}

/// Same as `outward`, rounded up.
fn outward_up(tension: Int) -> Int {
    ((tension.max(0) + (1 << GAIN) - 1) >> GAIN).min(HIGHEST)
}

/// A share of a signal, towards zero.
fn share(ratio: Int, x: Int) -> Int {
    cut(times(ratio, x), SIGNAL).clamp(-HIGHEST, HIGHEST)
}

/// The position that a tension holds in a spring, towards zero.
fn per(tension: Int, stiffness: Int) -> Int {
    towards_zero(tension, stiffness).clamp(-HIGHEST, HIGHEST)
}

fn size(x: Int) -> Int {
    x.abs().min(HIGHEST)
}

impl Enhanced {
    /// One tick at the penetration `e` after a displacement `moved`: memory and force.
    #[must_use]
    pub fn tick(&self, memory: &Memory, e: Int, moved: Int) -> (Memory, Int) {
        let mut m = *memory;
        if m.contact == Contact::Free && e > 0 {
            let force = outward(times(self.desired, e)).min(self.limit);
            let (contact, energy) = (Contact::First, self.credit);
            let first = Memory {
                contact,
                energy,
                force,
                last: e,
                ..Memory::default()
            };
            return (first, self.damped(force, e, moved));
        }
        if m.contact == Contact::First {
            m.energy = (m.energy + times(m.force, moved)).min(self.energy_cap);
            if moved < 0 && e > 0 {
                m = self.hand_over(&m);
            }
        }
        let force = match m.contact {
            Contact::Free => None,
            Contact::First => (e > 0).then(|| outward(times(self.desired, e))),
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
            self.damped(force, e, moved),
        )
    }

    /// The force with a damper beside the wall, on the displacement inside it, never pulling.
    #[must_use]
    pub fn damped(&self, force: Int, e: Int, moved: Int) -> Int {
        let damping = cut(times(self.damper, moved.min(e)), GAIN).clamp(-HIGHEST, HIGHEST);
        signal(force + damping).max(0).min(self.limit)
    }

    /// The first contact ends: the mass takes over, with the energy that is left.
    #[must_use]
    pub fn hand_over(&self, m: &Memory) -> Memory {
        let e = m.last;
        let (mass, offset) = if self.keep_force {
            let mass = signal(e - per(m.force << GAIN, self.coupling));
            (mass, signal(share(self.compliance, m.force) - mass).max(0))
        } else {
            (per(times(self.coupling, e), self.series), 0)
        };
        // Half of the coupling's force times its stretch, both rounded up; a force beyond the format is not granted.
        let stretch = size(signal(e - mass));
        let tension = times(self.coupling, stretch);
        let stored = (times(outward_up(tension), stretch) + 1) >> 1;
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
            at_mass: outward(times(self.soft, signal(mass + offset))),
            ..*m
        }
    }

    /// Algorithm 3.1, lines 7 to 13.
    #[must_use]
    pub fn offset(&self, m: &Memory, e: Int) -> Int {
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
    fn displacement(&self, from: Int, drive: Int, force: Int) -> Int {
        let step = per(drive - (force << GAIN), self.total);
        signal(signal(from + step) - from)
    }

    /// What drives the mass, but for the wall: `m d/T² + k_f (e - x) + c_f Δe/T`.
    #[must_use]
    pub fn drive(&self, mass: Int, mass_moved: Int, e: Int, moved: Int) -> Int {
        times(self.inertia, mass_moved)
            + times(self.coupling, signal(e - mass))
            + times(self.damping, moved)
    }

    /// The force of the coupling on the HIP, towards zero.
    #[must_use]
    pub fn coupled(&self, mass: Int, mass_moved: Int, e: Int, moved: Int) -> Int {
        let stretch = times(self.coupling, signal(e - mass));
        let tension = stretch + times(self.damping, signal(moved - mass_moved));
        cut(tension, GAIN).clamp(-HIGHEST, HIGHEST)
    }

    /// The force on the HIP; `None` outside.
    fn augmented(&self, m: &mut Memory, e: Int, moved: Int) -> Option<Int> {
        m.offset = self.offset(m, e);
        let wanted = outward(times(self.soft, signal(m.mass + m.offset)));
        if wanted == 0 {
            return None;
        }
        let before = *m;
        let drive = self.drive(m.mass, m.mass_moved, e, moved);
        let step;
        (m.energy, m.at_mass, step) = if self.exact {
            self.paid_move(m.energy, m.mass, drive, wanted)
        } else {
            // Fig. 3.18: the last displacement stands for the next.
            let (energy, force) = passive(m.energy, wanted, m.mass_moved, self.energy_cap);
            let step = self.displacement(m.mass, drive, force);
            (energy, force, step)
        };
        (m.mass, m.mass_moved) = (signal(m.mass + step), step);
        let shown = self.coupled(m.mass, m.mass_moved, e, moved);
        if shown > 0 || shown == 0 && e > 0 {
            return Some(shown);
        }
        if e <= 0 {
            return None;
        }
        // A wall does not pull: the mass goes on as if it were not coupled, if that is paid for.
        let force = if self.exact { wanted } else { m.at_mass };
        let coast = self.displacement(before.mass, times(self.inertia, before.mass_moved), force);
        let mut step = coast;
        if self.exact {
            let after = before.energy + times(force, coast);
            let paid = after >= 0;
            step = if paid { coast } else { 0 };
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
    #[must_use]
    pub fn paid_move(&self, energy: Int, mass: Int, drive: Int, wanted: Int) -> (Int, Int, Int) {
        let step = self.displacement(mass, drive, wanted);
        let after = energy + times(wanted, step);
        if after >= 0 {
            return (after.min(self.energy_cap), wanted, step);
        }
        let retreat = over(energy, wanted);
        let force = outward_up(drive + times(self.total, retreat)).min(wanted);
        if force == 0 {
            return (energy, 0, self.displacement(mass, drive, 0));
        }
        (energy - times(force, retreat), force, -retreat)
    }
}
