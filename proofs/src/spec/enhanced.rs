//! Specification tick of the enhanced SFA law (thesis Algorithm 3.1 and Fig. 3.18; the virtual mass of §3.5 by backward Euler).

use super::tdpa::passive;
use super::{GAIN, HIGHEST, Int, SIGNAL, cut, over, signal, spring, times, towards_zero};

/// The law's coefficients, in quanta.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Enhanced {
    /// `k_de`: stiffness that the wall should show, in the format of gains.
    pub desired: Int,
    /// Stiffness towards which the offset regulates, in the format of gains.
    pub target: Int,
    /// `B/T`: damping per tick of the damper beside the wall, in the format of gains.
    pub damper: Int,
    /// `k_v`: stiffness of the virtual spring, in the format of gains.
    pub soft: Int,
    /// `1/k_v`: compliance of the virtual spring, in the format of ratios.
    pub compliance: Int,
    /// Fraction of the ideal step of the offset (thesis 3.7, 3.8), in the format of ratios.
    pub of_ideal: Int,
    /// `b/k_v`: largest step of the offset per force (thesis 3.9), in the format of ratios.
    pub of_force: Int,
    /// `a`: largest step of the offset per penetration (thesis 3.11), in the format of ratios.
    pub of_penetration: Int,
    /// Whether the law regulates the stiffness at the HIP instead of that at the virtual mass.
    pub at_hip: bool,
    /// Whether the offset changes at every tick, not only while the virtual mass moves inward.
    pub every_tick: bool,
    /// Whether the energy counts the next displacement of the virtual mass instead of its last one.
    pub exact: bool,
    /// Whether the force is kept where the first contact phase ends (thesis 2.16, 2.17).
    pub keep_force: bool,
    /// `m/T²`: inertia of the virtual mass per tick², in the format of gains.
    pub inertia: Int,
    /// `k_f`: stiffness of the coupling between HIP and virtual mass, in the format of gains.
    pub coupling: Int,
    /// `c_f/T`: damping of the coupling, in the format of gains.
    pub damping: Int,
    /// `m/T² + k_f + c_f/T + c_env/T`: the sum that multiplies the displacement of the virtual mass, in the format of gains.
    pub total: Int,
    /// `k_f + k_v`: coupling and virtual spring together, in the format of gains.
    pub series: Int,
    /// Energy lent to each contact, in quanta.
    pub credit: Int,
    /// Most energy that the law stores, in quanta.
    pub energy_cap: Int,
    /// Largest force, in quanta.
    pub limit: Int,
}

/// Phase of the contact between HIP and wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Contact {
    /// The HIP is outside the wall.
    #[default]
    Free,
    /// The phase of contact up to the first reversal of the motion.
    First,
    /// The phase of contact after the first reversal, in which the force is augmented.
    Augmenting,
}

/// The law's memory between ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Memory {
    /// Phase of the contact.
    pub contact: Contact,
    /// Penetration of the last tick.
    pub last: Int,
    /// Force of the wall at the HIP, without that of the damper beside the wall.
    pub force: Int,
    /// Energy that the law may still give, the loan included.
    pub energy: Int,
    /// Penetration of the virtual mass.
    pub mass: Int,
    /// Displacement of the virtual mass in the last tick.
    pub mass_moved: Int,
    /// `O`: offset of the virtual spring's surface.
    pub offset: Int,
    /// Force of the wall on the virtual mass.
    pub at_mass: Int,
}

/// Outward force that a tension of the coupling gives, rounded down; 0 if the tension points inward.
fn outward(tension: Int) -> Int {
    (tension.max(0) >> GAIN).min(HIGHEST)
}

/// Outward force that a tension of the coupling gives, rounded up; 0 if the tension points inward.
fn outward_up(tension: Int) -> Int {
    ((tension.max(0) + (1 << GAIN) - 1) >> GAIN).min(HIGHEST)
}

/// The product of a ratio and a signal (position or force), rounded towards zero.
fn share(ratio: Int, x: Int) -> Int {
    cut(times(ratio, x), SIGNAL).clamp(-HIGHEST, HIGHEST)
}

/// The deflection of a spring at a tension, rounded towards zero.
fn per(tension: Int, stiffness: Int) -> Int {
    towards_zero(tension, stiffness).clamp(-HIGHEST, HIGHEST)
}

fn size(x: Int) -> Int {
    x.abs().min(HIGHEST)
}

impl Enhanced {
    /// One tick at the penetration `e` after a displacement `moved`: returns memory and force.
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

    /// Adds to a force that of the damper beside the wall. The damper acts on the displacement inside the wall; the sum never pulls
    /// inward.
    #[must_use]
    pub fn damped(&self, force: Int, e: Int, moved: Int) -> Int {
        let damping = cut(times(self.damper, moved.min(e)), GAIN).clamp(-HIGHEST, HIGHEST);
        signal(force + damping).max(0).min(self.limit)
    }

    /// Ends the first contact phase: the virtual mass takes over, with the energy that is left.
    #[must_use]
    pub fn hand_over(&self, m: &Memory) -> Memory {
        let e = m.last;
        let (mass, offset) = if self.keep_force {
            let mass = signal(e - per(m.force << GAIN, self.coupling));
            (mass, signal(share(self.compliance, m.force) - mass).max(0))
        } else {
            (per(times(self.coupling, e), self.series), 0)
        };
        // Energy of the coupling: half of its force times its stretch, both rounded up. A force beyond the format is not covered.
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

    /// The new offset: Algorithm 3.1, lines 7 to 13.
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

    /// Displacement of the virtual mass, `d' = (N0 - f)/D`, rounded towards zero and limited to the range of positions.
    fn displacement(&self, from: Int, drive: Int, force: Int) -> Int {
        let step = per(drive - (force << GAIN), self.total);
        signal(signal(from + step) - from)
    }

    /// Drive of the virtual mass without the wall's force: `m d/T² + k_f (e - x) + c_f Δe/T`.
    #[must_use]
    pub fn drive(&self, mass: Int, mass_moved: Int, e: Int, moved: Int) -> Int {
        times(self.inertia, mass_moved)
            + times(self.coupling, signal(e - mass))
            + times(self.damping, moved)
    }

    /// Force of the coupling on the HIP, rounded towards zero.
    #[must_use]
    pub fn coupled(&self, mass: Int, mass_moved: Int, e: Int, moved: Int) -> Int {
        let stretch = times(self.coupling, signal(e - mass));
        let tension = stretch + times(self.damping, signal(moved - mass_moved));
        cut(tension, GAIN).clamp(-HIGHEST, HIGHEST)
    }

    /// Force on the HIP in the augmenting phase; `None` if the contact has ended.
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
            // Fig. 3.18: the last displacement is used in place of the next one.
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
        // A wall does not pull: the mass moves on as if it were not coupled, if its energy covers that.
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

    /// Energy, force and displacement of the virtual mass such that `E' = E + f d' >= 0`.
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
