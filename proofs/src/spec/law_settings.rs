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

/// Most energy that a law stores: half of the format's largest magnitude.
pub const ENERGY_CAP: Int = 1 << (2 * BITS - 2);

/// The stiffness that the enhanced law regulates by changing its offset.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Regulated {
    /// Force over position of the virtual mass is regulated to `k_de`.
    Mass,
    /// The virtual mass' stiffness is regulated so that the HIP feels `k_de` (thesis 3.5).
    MassCompensated,
    /// Force over position of the HIP is regulated to `k_de` (thesis 3.6).
    Hip,
}

/// Settings of a law as integers, in units of 2^-32 of their SI units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Control rate, a whole number of Hz.
    pub rate: Int,
    /// `k_de`: stiffness that the wall should show, N·m/rad.
    pub desired: Int,
    /// `k_v`: stiffness of the virtual spring, N·m/rad.
    pub soft: Int,
    /// `c_i`: damping of the device, N·m·s/rad.
    pub device_damping: Int,
    /// `b`: virtual damping, N·m·s/rad.
    pub virtual_damping: Int,
    /// Whether the law counts the port's energy (`f(n-1) Δe`) instead of the thesis' sum (2.1).
    pub exact: bool,
    /// Whether TDPA counts the energy that the device's damping dissipates (thesis 2.6).
    pub counts_damping: bool,
    /// Whether the force is kept where the first contact phase ends (thesis 2.16, 2.17).
    pub keep_force: bool,
    /// The stiffness towards which the offset regulates.
    pub regulated: Regulated,
    /// The moments at which the offset of the wall's surface changes.
    pub update: Update,
    /// Whether the ideal step assumes that the hand's force stays (`c/k_de`) instead of its position (`c/k_v`, 3.7).
    pub force_stays: bool,
    /// `c`: fraction of the ideal step of the offset (thesis 3.8), per millisecond.
    pub step_of_ideal: Int,
    /// `b`: largest step of the offset per force (thesis 3.9), per millisecond.
    pub limit_of_force: Int,
    /// `a`: largest step of the offset per penetration (thesis 3.11), per millisecond.
    pub limit_of_penetration: Int,
    /// `m`: virtual mass (an inertia), kg·m².
    pub mass: Int,
    /// `k_f`: stiffness of the coupling, N·m/rad.
    pub coupling: Int,
    /// `c_f`: damping of the coupling, N·m·s/rad.
    pub filter_damping: Int,
    /// `c_env`: damping between virtual mass and ground, N·m·s/rad.
    pub ground_damping: Int,
    /// Energy lent to each contact, J.
    pub credit: Int,
    /// Force limit, N·m.
    pub limit: Int,
}

/// A spring with damping: `k_de` and `b/T` as gains, and the largest force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Spring {
    /// `k_de`: stiffness of the wall, in the format of gains.
    pub desired: Int,
    /// `b/T`: damping per tick, in the format of gains.
    pub damping: Int,
    /// Largest force, in quanta.
    pub limit: Int,
}

fn gain(x: Int) -> Option<Int> {
    gain_fits(x).then(|| gain_of(x))
}
/// A setting as a ratio, a compliance or a signal (position or force); `None` if it does not fit.
fn signal(x: Int) -> Option<Int> {
    signal_fits(x).then(|| signal_of(x))
}

/// Damping and inertia per tick, in units of 2^-32 N·m/rad.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Derived {
    /// Critical stiffness `k_c = 2 c_i/T`.
    pub critical: Int,
    /// Inertia of the virtual mass: `m/T²`.
    pub inertia: Int,
    /// Damping of the coupling: `c_f/T`.
    pub filter_damping: Int,
    /// Damping between virtual mass and ground: `c_env/T`.
    pub ground_damping: Int,
    /// Damping of the device: `c_i/T`.
    pub device_damping: Int,
    /// Virtual damping: `b/T`.
    pub virtual_damping: Int,
}

/// Values that follow from several settings; [`crate::reckoned`] says what replaces them under the model checker.
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

/// Which damping a spring has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Damped {
    /// The spring has no damping.
    Not,
    /// The configured damping `b`.
    Fully,
    /// Damping `b k_de/k_v`, for the enhanced law with a stiffness `k_de` up to that of its virtual spring, `k_v`.
    InProportion,
}

impl Settings {
    /// The spring law `f = k_de e + (b/T) Δe` (thesis 1.6); `None` if a coefficient does not fit.
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

    /// The TDPA law (thesis 2.1 to 2.6); `None` if a coefficient does not fit.
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

    /// The FBA law (thesis 2.6a to 2.10), with the force bound of the damping as it is stored. `None` if a coefficient
    /// does not fit.
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

    /// The SFA law (thesis 2.14a). The offset's step is `(k_c/k_v - 1) Δe` with `k_c = 2 c_i/T`, and 0 for a device with
    /// `k_c < k_v`. `None` if a coefficient does not fit.
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

    /// Whether the enhanced law is a plain spring, because the stiffness needs no augmentation (§3.1).
    #[must_use]
    pub fn is_plain(&self) -> bool {
        self.desired <= self.soft
    }

    /// The enhanced law: Algorithm 3.1 with the virtual mass of Fig. 3.18. `None` unless twice the sum of the mass' gains fits, its
    /// coupling is not 0, and the loan is at most the cap.
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
        // The thesis' observer lends by itself; it needs no credit.
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
