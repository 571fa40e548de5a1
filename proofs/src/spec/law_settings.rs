//! What `AnyLaw::new` makes of a person's settings: the coefficients of each law, beside the thesis' equations.

use super::enhanced::Enhanced;
use super::fba::Fba;
use super::settings::{
    MOST, ONE, energy_fits, energy_of, gain_fits, gain_of, over, plus, signal_fits, signal_of,
    times,
};
use super::sfa::{Sfa, Update};
use super::tdpa::Tdpa;
use super::{BITS, Int};

/// Most that a law stores: half of the format's largest magnitude.
pub const ENERGY_CAP: Int = 1 << (2 * BITS - 2);

/// The stiffness by which the enhanced law's offset is regulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Regulated {
    /// Force over position of the mass, towards `k_de`.
    Mass,
    /// The mass, regulated to what the HIP then feels as `k_de` (3.5).
    MassCompensated,
    /// Force over position of the HIP (3.6).
    Hip,
}

/// Settings, counts of 2^-32 of their SI units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Hz, a whole number.
    pub rate: Int,
    /// `k_de`, N·m/rad.
    pub desired: Int,
    /// `k_v`, N·m/rad.
    pub soft: Int,
    /// `c_i`, N·m·s/rad.
    pub device_damping: Int,
    /// `b`, N·m·s/rad.
    pub virtual_damping: Int,
    /// The port's energy is counted (`f(n-1) Δe`), not the thesis' sum (2.1).
    pub exact: bool,
    /// TDPA counts the device's damping (2.6).
    pub counts_damping: bool,
    /// The force of the first contact is kept at its end (2.16, 2.17).
    pub keep_force: bool,
    /// Towards which stiffness the offset goes.
    pub regulated: Regulated,
    /// The moments at which the offset is changed.
    pub update: Update,
    /// The ideal step supposes that the hand's force stays (`c/k_de`), not its position (`c/k_v`, 3.7).
    pub force_stays: bool,
    /// `c` (3.8), per millisecond.
    pub step_of_ideal: Int,
    /// `b` (3.9), per millisecond.
    pub limit_of_force: Int,
    /// `a` (3.11), per millisecond.
    pub limit_of_penetration: Int,
    /// `m`, kg·m².
    pub mass: Int,
    /// `k_f`, N·m/rad.
    pub coupling: Int,
    /// `c_f`, N·m·s/rad.
    pub filter_damping: Int,
    /// `c_env`, N·m·s/rad.
    pub ground_damping: Int,
    /// Lent to each contact, J.
    pub credit: Int,
    /// Limit, N·m.
    pub limit: Int,
}

/// A spring with damping: `k_de` and `b/T`, gains, and the largest force.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Spring {
    /// `k_de`, a gain.
    pub desired: Int,
    /// `b/T`, a gain.
    pub damping: Int,
    /// Largest force.
    pub limit: Int,
}

fn gain(x: Int) -> Option<Int> {
    gain_fits(x).then(|| gain_of(x))
}
/// A ratio, a compliance or a signal.
fn signal(x: Int) -> Option<Int> {
    signal_fits(x).then(|| signal_of(x))
}

/// Damping and inertia per tick, counts of 2^-32 N·m/rad.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Derived {
    /// `k_c = 2 c_i/T`.
    pub critical: Int,
    /// Inertia: `m/T²`.
    pub inertia: Int,
    /// Filter damping: `c_f/T`.
    pub filter_damping: Int,
    /// Ground damping: `c_env/T`.
    pub ground_damping: Int,
    /// Device damping: `c_i/T`.
    pub device_damping: Int,
    /// Virtual damping: `b/T`.
    pub virtual_damping: Int,
}

/// Values that follow from several settings; [`crate::reckoned`] says what the checker puts in their place.
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

/// Damping of a spring.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Damped {
    /// No damping.
    Not,
    /// `b`.
    Fully,
    /// `b k_de/k_v`: the enhanced law up to `k_v`.
    InProportion,
}

impl Settings {
    /// `f = k_de e + (b/T) Δe` (1.6).
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

    /// (2.1) to (2.6).
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

    /// (2.6a) to (2.10), the bound of the damping as stored.
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

    /// (2.14a): the offset's step is `(k_c/k_v - 1) Δe`, none for a device with `k_c < k_v`; `k_c = 2 c_i/T`.
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

    /// Whether the enhanced law is the spring: a stiffness that needs no augmentation (§3.1).
    #[must_use]
    pub fn is_plain(&self) -> bool {
        self.desired <= self.soft
    }

    /// Algorithm 3.1 with the virtual mass of Fig. 3.18; twice the mass' sum fits, its coupling does not vanish, the loan is within the cap.
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
        // The thesis' observer lends what it needs by itself.
        let lent = if self.exact { self.credit } else { 0 };
        // Shares per millisecond become shares per tick, at most all of it.
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
