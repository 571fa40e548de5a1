//! Specification of `AnyLaw::new`: the coefficients of each law that follow from a user's settings. Read it beside the thesis'
//! equations.

use super::enhanced::Enhanced;
use super::fba::Fba;
use super::settings::{
    MOST, ONE, energy_fits, energy_of, gain_fits, gain_of, over, plus, signal_fits, signal_of,
    times,
};
use super::sfa::{Sfa, Update};
use super::tdpa::Tdpa;
use super::{BITS, Int};

/// Most energy that a law stores: half of the largest energy of the format.
pub const ENERGY_CAP: Int = 1 << (2 * BITS - 2);

/// The stiffness that the enhanced law regulates by changing its offset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Regulated {
    /// Force over position of the virtual mass is regulated to the desired stiffness.
    Mass,
    /// The stiffness at the virtual mass is regulated so that the hand feels the desired stiffness (thesis 3.5).
    MassCompensated,
    /// Force over position of the hand's point (HIP) is regulated to the desired stiffness (thesis 3.6).
    Hip,
}

/// Settings of a law as integers, in units of 2^-32 of their SI units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Control rate, a whole number of Hz.
    pub rate: Int,
    /// Desired stiffness of the wall, N·m/rad.
    pub desired: Int,
    /// Stiffness of the soft virtual spring, N·m/rad.
    pub soft: Int,
    /// Damping of the device, N·m·s/rad.
    pub device_damping: Int,
    /// Virtual damping, N·m·s/rad.
    pub virtual_damping: Int,
    /// Whether the law counts the true energy, last force times displacement, instead of the thesis' sum (2.1) with the new force.
    pub exact: bool,
    /// Whether the law TDPA counts the energy that the device's damping dissipates (thesis 2.6).
    pub counts_damping: bool,
    /// Whether the force stays the same at the end of the contact's first phase (thesis 2.16, 2.17); otherwise the offset starts at
    /// zero.
    pub keep_force: bool,
    /// The stiffness that the law reaches by changing the offset.
    pub regulated: Regulated,
    /// The ticks in which the offset of the soft spring changes.
    pub update: Update,
    /// Whether the offset's ideal step assumes that the hand's force stays constant, instead of its position (thesis 3.7).
    pub force_stays: bool,
    /// Fraction of the offset's ideal step that the law goes per millisecond (thesis 3.8).
    pub step_of_ideal: Int,
    /// Largest step of the force by the offset, as a fraction of the force per millisecond (thesis 3.9).
    pub limit_of_force: Int,
    /// Largest step of the offset, as a fraction of the penetration per millisecond (thesis 3.11).
    pub limit_of_penetration: Int,
    /// Virtual mass (an inertia), kg·m².
    pub mass: Int,
    /// Stiffness of the coupling between hand's point and virtual mass, N·m/rad.
    pub coupling: Int,
    /// Damping of the coupling between hand's point and virtual mass, N·m·s/rad.
    pub filter_damping: Int,
    /// Damping between virtual mass and ground, N·m·s/rad.
    pub ground_damping: Int,
    /// Energy lent to each contact, J.
    pub credit: Int,
    /// Force limit, N·m.
    pub limit: Int,
}

/// Coefficients of a spring with damping: stiffness, damping per tick, and the largest force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Spring {
    /// Stiffness of the wall, in the number format of stiffnesses.
    pub desired: Int,
    /// Damping divided by the control period, in the number format of stiffnesses.
    pub damping: Int,
    /// Largest force, in steps of the force format.
    pub limit: Int,
}

fn gain(x: Int) -> Option<Int> {
    gain_fits(x).then(|| gain_of(x))
}
/// Converts a setting to a ratio, a compliance, a position or a force; `None` if it does not fit.
fn signal(x: Int) -> Option<Int> {
    signal_fits(x).then(|| signal_of(x))
}

/// Damping and inertia per tick, in units of 2^-32 N·m/rad.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Derived {
    /// Critical stiffness, the largest that the device's damping makes passive: twice the damping divided by the control period.
    pub critical: Int,
    /// Inertia of the virtual mass divided by the squared control period.
    pub inertia: Int,
    /// Damping of the damper between hand's point and virtual mass, divided by the control period.
    pub filter_damping: Int,
    /// Damping between virtual mass and ground, divided by the control period.
    pub ground_damping: Int,
    /// Damping of the device divided by the control period.
    pub device_damping: Int,
    /// Virtual damping divided by the control period.
    pub virtual_damping: Int,
}

/// Damping and inertia per tick, computed from several settings. When the model checker runs, [`crate::reckoned`] replaces them.
#[must_use]
pub fn derived(of: &Settings) -> Derived {
    let per_tick = |damping| times(damping, (of.rate * ONE).min(MOST));
    Derived {
        critical: times(per_tick(of.device_damping), 2 * ONE),
        inertia: per_tick(per_tick(of.mass)),
        filter_damping: per_tick(of.filter_damping),
        ground_damping: per_tick(of.ground_damping),
        device_damping: per_tick(of.device_damping),
        virtual_damping: per_tick(of.virtual_damping),
    }
}

/// Which damping a spring law has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Damped {
    /// The spring has no damping.
    Not,
    /// The configured virtual damping.
    Fully,
    /// The virtual damping times the desired stiffness divided by the soft one. The enhanced law has it for a desired stiffness up
    /// to the soft one.
    InProportion,
}

impl Settings {
    /// The coefficients of the spring law (thesis 1.6), stiffness times penetration plus damping per tick times displacement.
    /// `None` if a coefficient does not fit.
    #[must_use]
    pub fn spring(&self, damped: Damped) -> Option<Spring> {
        let per_tick = derived(self).virtual_damping;
        let damping = match damped {
            Damped::Not => 0,
            Damped::Fully => per_tick,
            Damped::InProportion => times(per_tick, over(self.desired, self.soft)),
        };
        Some(Spring {
            desired: gain(self.desired)?,
            damping: gain(damping)?,
            limit: signal(self.limit)?,
        })
    }

    /// The coefficients of the TDPA law, time-domain passivity (thesis 2.1 to 2.6); `None` if one does not fit.
    #[must_use]
    pub fn tdpa(&self) -> Option<Tdpa> {
        Some(Tdpa {
            desired: gain(self.desired)?,
            exact: self.exact,
            device_damping: if self.counts_damping {
                gain(derived(self).device_damping)?
            } else {
                0
            },
            limit: signal(self.limit)?,
            energy_cap: ENERGY_CAP,
        })
    }

    /// The coefficients of the FBA law, force bounding (thesis 2.6a to 2.10). The factor of the force bound follows from the
    /// damping as it is stored. `None` if a coefficient does not fit.
    #[must_use]
    pub fn fba(&self) -> Option<Fba> {
        let device_damping = gain(derived(self).device_damping)?;
        Some(Fba {
            desired: gain(self.desired)?,
            device_damping,
            bound: Fba::bound_of(device_damping),
            limit: signal(self.limit)?,
            energy_cap: ENERGY_CAP,
        })
    }

    /// The coefficients of the SFA law, successive force augmentation (thesis 2.14a). The offset's step per displacement is the
    /// critical stiffness divided by the soft one, minus 1; it is 0 if that is negative. `None` if a coefficient does not fit.
    #[must_use]
    pub fn sfa(&self, update: Update) -> Option<Sfa> {
        let critical = derived(self).critical;
        Some(Sfa {
            desired: gain(self.desired)?,
            soft: gain(self.soft)?,
            gain: signal((over(critical, self.soft) - ONE).max(0))?,
            compliance: signal(over(ONE, self.soft))?,
            update,
            keep_force: self.keep_force,
            limit: signal(self.limit)?,
        })
    }

    /// Whether the enhanced law is a plain spring, because the desired stiffness needs no augmentation (thesis §3.1).
    #[must_use]
    pub fn is_plain(&self) -> bool {
        self.desired <= self.soft
    }

    /// The coefficients of the enhanced law (thesis Algorithm 3.1) with its virtual mass. `None` unless twice the sum of the mass'
    /// gains fits, the coupling is not 0, and the lent energy is at most the energy cap.
    #[must_use]
    pub fn enhanced(&self) -> Option<Enhanced> {
        let derived = derived(self);
        // (3.5): `1/(1/k_de - 1/k_f)`.
        let target = if self.regulated == Regulated::MassCompensated {
            over(
                times(self.desired, self.coupling),
                self.coupling - self.desired,
            )
        } else {
            self.desired
        };
        let total = plus(
            plus(plus(derived.inertia, self.coupling), derived.filter_damping),
            derived.ground_damping,
        );
        // The thesis' observer needs no credit: its energy sum with the new force lends by itself.
        let lent = if self.exact { self.credit } else { 0 };
        // Fractions per millisecond become fractions per tick, at most 1.
        let of_tick = |share| over(times(share, 1000 * ONE), (self.rate * ONE).min(MOST)).min(ONE);
        let compliance = over(ONE, self.soft);
        let of_force = over(of_tick(self.limit_of_force), self.soft);
        let of_penetration = of_tick(self.limit_of_penetration);
        let of_ideal = over(
            of_tick(self.step_of_ideal),
            if self.force_stays {
                self.desired
            } else {
                self.soft
            },
        );
        let series = plus(self.coupling, self.soft);
        let gains = [
            self.desired,
            target,
            derived.virtual_damping,
            self.soft,
            derived.inertia,
            self.coupling,
            derived.filter_damping,
            times(total, 2 * ONE),
            total,
            series,
        ];
        let signals = [compliance, of_ideal, of_force, of_penetration, self.limit];
        let fits = gains.into_iter().all(gain_fits)
            && signals.into_iter().all(signal_fits)
            && gain_of(self.coupling) > 0
            && energy_fits(lent)
            && energy_of(lent) <= ENERGY_CAP;
        fits.then(|| Enhanced {
            desired: gain_of(self.desired),
            target: gain_of(target),
            damper: gain_of(derived.virtual_damping),
            soft: gain_of(self.soft),
            compliance: signal_of(compliance),
            of_ideal: signal_of(of_ideal),
            of_force: signal_of(of_force),
            of_penetration: signal_of(of_penetration),
            at_hip: self.regulated == Regulated::Hip,
            every_tick: self.update == Update::EveryTick,
            exact: self.exact,
            keep_force: self.keep_force,
            inertia: gain_of(derived.inertia),
            coupling: gain_of(self.coupling),
            damping: gain_of(derived.filter_damping),
            total: gain_of(total),
            series: gain_of(series),
            credit: energy_of(lent),
            energy_cap: ENERGY_CAP,
            limit: signal_of(self.limit),
        })
    }
}
