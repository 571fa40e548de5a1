//! Specification of a tick of the enhanced law, successive force augmentation with a virtual mass (thesis Algorithm 3.1; the
//! virtual mass of §3.5 by backward Euler).

use super::tdpa::passive;
use super::{GAIN, HIGHEST, Int, SIGNAL, cut, over, signal, spring, times, towards_zero};

/// The enhanced law's coefficients, as integers in steps of their number formats.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Enhanced {
    /// Desired stiffness of the wall, in the number format of stiffnesses.
    pub desired: Int,
    /// Stiffness that the law reaches by changing the offset, in the number format of stiffnesses.
    pub target: Int,
    /// Damping of the damper whose force is added to the wall's, divided by the control period, in the number format of
    /// stiffnesses.
    pub damper: Int,
    /// Stiffness of the soft virtual spring, in the number format of stiffnesses.
    pub soft: Int,
    /// Compliance of the soft virtual spring, in the number format of ratios.
    pub compliance: Int,
    /// Gain of the offset's ideal step from the error of the force (thesis 3.7, 3.8), in the number format of ratios.
    pub of_ideal: Int,
    /// Largest step of the offset for each unit of force (thesis 3.9), in the number format of ratios.
    pub of_force: Int,
    /// Largest step of the offset for each unit of penetration (thesis 3.11), in the number format of ratios.
    pub of_penetration: Int,
    /// Whether the law regulates the stiffness at the hand's point (HIP) instead of that at the virtual mass.
    pub at_hip: bool,
    /// Whether the offset changes at every tick, not only while the virtual mass moves inward.
    pub every_tick: bool,
    /// Whether the stored energy counts the next displacement of the virtual mass (exact observer) instead of its last one
    /// (thesis).
    pub exact: bool,
    /// Whether the force stays the same at the end of the contact's first phase (thesis 2.16, 2.17); otherwise the offset starts at
    /// zero.
    pub keep_force: bool,
    /// Inertia of the virtual mass divided by the squared control period, in the number format of stiffnesses.
    pub inertia: Int,
    /// Stiffness of the coupling between hand's point (HIP) and virtual mass, in the number format of stiffnesses.
    pub coupling: Int,
    /// Damping of the damper between hand's point (HIP) and virtual mass, divided by the control period, in the number format of
    /// stiffnesses.
    pub damping: Int,
    /// Sum of the virtual mass' inertia, coupling stiffness, coupling damping and ground damping per tick, in the number format of
    /// stiffnesses. The mass' displacement is the net force divided by this sum.
    pub total: Int,
    /// Sum of the coupling's stiffness and the soft spring's stiffness, in the number format of stiffnesses.
    pub series: Int,
    /// Energy lent to each contact, in steps of the energy format.
    pub credit: Int,
    /// Most energy that the law stores, in steps of the energy format.
    pub energy_cap: Int,
    /// Largest force, in steps of the force format.
    pub limit: Int,
}

/// Phase of the contact between hand and wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Contact {
    /// The hand's point (HIP) is outside the wall.
    #[default]
    Free,
    /// The contact before the first reversal of the motion.
    First,
    /// The contact after the first reversal of the motion, in which the force is augmented by an offset.
    Augmenting,
}

/// The enhanced law's memory between ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Memory {
    /// Phase of the contact.
    pub contact: Contact,
    /// Penetration of the last tick.
    pub last: Int,
    /// Force of the wall at the hand's point (HIP), without the force of the parallel damper.
    pub force: Int,
    /// Energy that the law may still give, the lent energy included.
    pub energy: Int,
    /// Penetration of the virtual mass.
    pub mass: Int,
    /// Displacement of the virtual mass in the last tick.
    pub mass_moved: Int,
    /// Offset: deformation of the soft spring beyond the penetration of the virtual mass.
    pub offset: Int,
    /// Force of the wall on the virtual mass.
    pub at_mass: Int,
}

/// The force that pushes out of the wall, from an unrounded force: rounded down, and 0 if it would pull.
fn outward(tension: Int) -> Int {
    (tension.max(0) >> GAIN).min(HIGHEST)
}

/// The force that pushes out of the wall, from an unrounded force: rounded up, and 0 if it would pull.
fn outward_up(tension: Int) -> Int {
    ((tension.max(0) + (1 << GAIN) - 1) >> GAIN).min(HIGHEST)
}

/// The product of a ratio and a position or force, rounded towards zero.
fn share(ratio: Int, x: Int) -> Int {
    cut(times(ratio, x), SIGNAL).clamp(-HIGHEST, HIGHEST)
}

/// The deflection of a spring under an unrounded force, rounded towards zero.
fn per(tension: Int, stiffness: Int) -> Int {
    towards_zero(tension, stiffness).clamp(-HIGHEST, HIGHEST)
}

fn size(x: Int) -> Int {
    x.abs().min(HIGHEST)
}

impl Enhanced {
    /// One tick at the penetration `e` after a displacement `moved`: returns the new memory and the force.
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

    /// Adds the damper's force to the wall's. The damper acts on the displacement inside the wall; the sum never pulls inward.
    #[must_use]
    pub fn damped(&self, force: Int, e: Int, moved: Int) -> Int {
        let damping = cut(times(self.damper, moved.min(e)), GAIN).clamp(-HIGHEST, HIGHEST);
        signal(force + damping).max(0).min(self.limit)
    }

    /// Ends the first phase of the contact: the virtual mass takes over, with the energy that is left.
    #[must_use]
    pub fn hand_over(&self, m: &Memory) -> Memory {
        let e = m.last;
        let (mass, offset) = if self.keep_force {
            let mass = signal(e - per(m.force << GAIN, self.coupling));
            (mass, signal(share(self.compliance, m.force) - mass).max(0))
        } else {
            (per(times(self.coupling, e), self.series), 0)
        };
        // Energy of the coupling: half of its force times its stretch, both rounded up. If the force is beyond the format, the
        // contact's energy counts as too small for it.
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

    /// The new offset of the soft spring: thesis Algorithm 3.1, lines 7 to 13.
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

    /// Displacement of the virtual mass: driving force minus the wall's force, divided by the sum of coefficients. It is rounded
    /// towards zero and limited to the range of positions.
    fn displacement(&self, from: Int, drive: Int, force: Int) -> Int {
        let step = per(drive - (force << GAIN), self.total);
        signal(signal(from + step) - from)
    }

    /// Force that drives the virtual mass, without the wall's force: inertia, coupling spring and coupling damper.
    #[must_use]
    pub fn drive(&self, mass: Int, mass_moved: Int, e: Int, moved: Int) -> Int {
        times(self.inertia, mass_moved)
            + times(self.coupling, signal(e - mass))
            + times(self.damping, moved)
    }

    /// Force of the coupling on the hand's point (HIP), rounded towards zero.
    #[must_use]
    pub fn coupled(&self, mass: Int, mass_moved: Int, e: Int, moved: Int) -> Int {
        let stretch = times(self.coupling, signal(e - mass));
        let tension = stretch + times(self.damping, signal(moved - mass_moved));
        cut(tension, GAIN).clamp(-HIGHEST, HIGHEST)
    }

    /// Force on the hand's point (HIP) after the first reversal of motion; `None` if the contact has ended.
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
        // A wall does not pull: the mass moves on as if it were not coupled, if the stored energy covers that motion.
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

    /// Stored energy after a tick, force on the virtual mass, and its displacement. The energy pays for the outward motion and does
    /// not become negative; if necessary, force and motion are reduced.
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
