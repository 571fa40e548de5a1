//! Calculates the coefficients of each control law from the settings.
//!
//! Each function builds one law. No function returns the enum of all laws, because that enum is large and each return path would
//! copy it.

use crate::choices::{IdealStep, OffsetUpdate, Regulate, StatesKind};
use crate::filter::VirtualMass;
use crate::law::{Augmentation, EnhancedSfa, Fba, Impact, Sfa, Spring, Tdpa, Vibration};
use crate::quotient::over;
use crate::validate::{gain, largest_force, ratio};
use crate::velocity::Velocity;
use crate::{
    Compliance, Divisor, Energy, Field, Force, Number, ObserverForm, Ratio, Settings,
    SettingsError, Si, Stiffness,
};

/// The coefficients that all control laws share: desired stiffness, force limit and the largest energy that a law stores.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Common<N: Number> {
    /// Desired stiffness of the wall, `k_de`.
    desired: Stiffness<N>,
    limit: Force<N>,
    energy_cap: Energy<N>,
}

fn stiffness<N: Number>(field: Field, value: Si) -> Result<Stiffness<N>, SettingsError> {
    gain::<N>(field, value).map(Stiffness)
}

impl<N: Number> Common<N> {
    /// Computes the shared coefficients from validated settings.
    pub fn new(settings: &Settings) -> Result<Self, SettingsError> {
        settings.validate()?;
        Ok(Self {
            desired: stiffness(Field::KDesired, settings.k_desired)?,
            limit: largest_force(settings)?,
            energy_cap: energy_cap::<N>(),
        })
    }

    /// A spring of the desired stiffness with a damper. `damping` is the damping over the control period, in N·m/rad.
    pub const fn spring(&self, damping: Stiffness<N>) -> Spring<N> {
        Spring {
            desired: self.desired,
            damping,
            limit: self.limit,
        }
    }

    /// A spring with virtual damping. Its velocity comes from a filter, unless the settings choose the plain difference of
    /// positions.
    pub fn damped(
        &self,
        settings: &Settings,
    ) -> Result<(Spring<N>, Option<Velocity<N>>), SettingsError> {
        let spring = self.spring(damper(settings)?);
        let (rate, count) = (settings.rate_hz, settings.position.count);
        Ok((spring, settings.velocity.velocity(rate, count)?))
    }

    pub fn tdpa(&self, settings: &Settings) -> Result<Tdpa<N>, SettingsError> {
        let device_damping = if settings.count_device_damping {
            let per_tick = settings.derived().device_damping_per_tick;
            stiffness(Field::DeviceDamping, per_tick)?
        } else {
            Stiffness::zero()
        };
        Ok(Tdpa {
            desired: self.desired,
            observer: settings.observer,
            device_damping,
            limit: self.limit,
            energy_cap: self.energy_cap,
        })
    }

    pub fn fba(&self, settings: &Settings) -> Result<Fba<N>, SettingsError> {
        let per_tick = settings.derived().device_damping_per_tick;
        let damping = stiffness::<N>(Field::DeviceDamping, per_tick)?;
        Ok(Fba {
            desired: self.desired,
            device_damping: damping,
            // The bound follows from the stored (rounded) damping and not from the configured one, because the law's energy sum
            // counts only the stored damping.
            bound: Stiffness(N::root_of_four(damping.0)),
            limit: self.limit,
            energy_cap: self.energy_cap,
        })
    }

    pub fn sfa(&self, settings: &Settings, update: OffsetUpdate) -> Result<Sfa<N>, SettingsError> {
        let derived = settings.derived();
        // Gain of equation (2.14a) of the thesis. With a critical stiffness k_c below the soft stiffness k_v the gain would be
        // negative and move the offset the wrong way, so it is 0.
        let step = over(derived.k_critical, settings.k_soft)
            .saturating_sub(Si::ONE)
            .max(Si::ZERO);
        Ok(Sfa {
            desired: self.desired,
            soft: Stiffness(gain::<N>(Field::KSoft, settings.k_soft)?),
            gain: Ratio(ratio::<N>(Field::DeviceDamping, step)?),
            compliance: Compliance(ratio::<N>(Field::KSoft, over(Si::ONE, settings.k_soft))?),
            update,
            first_contact: settings.first_contact,
            limit: self.limit,
        })
    }

    pub fn enhanced(&self, settings: &Settings) -> Result<EnhancedSfa<N>, SettingsError> {
        let filter = &settings.filter;
        let mass = virtual_mass(settings)?;
        let augmentation = augmentation(settings)?;
        // Equation (3.5) of the thesis: 1/(1/k_de - 1/k_f) = k_de k_f/(k_f - k_de), with k_de below k_f, which validation has
        // checked.
        let target = match settings.regulate {
            Regulate::MassCompensated => over(
                settings.k_desired.saturating_mul(filter.stiffness),
                filter.stiffness.saturating_sub(settings.k_desired),
            ),
            Regulate::Mass | Regulate::Hip => settings.k_desired,
        };
        let series = filter.stiffness.saturating_add(settings.k_soft);
        Ok(EnhancedSfa {
            desired: self.desired,
            damper: damper(settings)?,
            target: stiffness(Field::KDesired, target)?,
            soft: stiffness(Field::KSoft, settings.k_soft)?,
            compliance: compliance(settings, Field::KSoft, Si::ONE)?,
            augmentation,
            regulate: settings.regulate,
            update: settings.offset_update,
            observer: settings.observer,
            first_contact: settings.first_contact,
            mass,
            by_coupling: Divisor::of(mass.stiffness),
            series: Divisor::of(stiffness(Field::FilterStiffness, series)?),
            credit: self.credit(settings)?,
            energy_cap: self.energy_cap,
            limit: self.limit,
        })
    }

    /// Energy in joules that the enhanced law lends to each contact: the wall may give the hand this much more than it took.
    fn credit(&self, settings: &Settings) -> Result<Energy<N>, SettingsError> {
        // The thesis' observer counts the energy leak of sampling as a gain, so a contact needs no lent energy.
        let lent = match settings.observer {
            ObserverForm::Exact => settings.energy_credit,
            ObserverForm::Thesis => Si::ZERO,
        };
        // Lent energy above the cap would break the energy sums. In the 16-bit and 8-bit formats the cap is only 4 J and 1 J.
        N::energy(lent)
            .map(Energy)
            .filter(|credit| *credit <= self.energy_cap)
            .ok_or(SettingsError::OutOfFormat {
                field: Field::EnergyCredit,
                value: settings.energy_credit,
                format: N::NAME,
            })
    }
}

/// Virtual damping per tick in N·m/rad: the damping `B` over the control period `T`.
fn damper<N: Number>(settings: &Settings) -> Result<Stiffness<N>, SettingsError> {
    let per_tick = settings.derived().virtual_damping_per_tick;
    stiffness(Field::VirtualDamping, per_tick)
}

/// Damping per tick, N·m/rad, for desired stiffnesses `k_de` up to the soft stiffness `k_v`, where the enhanced law is a damped
/// spring. It is in proportion to `k_de`: with a constant damping a wall of half the stiffness would take twice as long to
/// settle.
pub(crate) fn soft_damper<N: Number>(settings: &Settings) -> Result<Stiffness<N>, SettingsError> {
    let whole = settings.derived().virtual_damping_per_tick;
    let share = over(settings.k_desired, settings.k_soft);
    stiffness(Field::VirtualDamping, whole.saturating_mul(share))
}

/// Shortest time outside a wall after which an entry is a new touch, as a rate in Hz: 20 ms. Noise and chatter at the surface are
/// faster.
const APART_HZ: u32 = 50;

impl<N: Number> Impact<N> {
    /// Pulse and vibration at the touch, for validated settings; `None` if the settings have neither. Pulse and vibration need
    /// the inertia and the speed of the estimator, so with measured states the result is `None` too.
    ///
    /// # Errors
    /// A coefficient does not fit the number format.
    pub fn pulse_of(settings: &Settings) -> Result<Option<Self>, SettingsError> {
        let share = settings.impact.momentum;
        if settings.states == StatesKind::Measured {
            return Ok(None);
        }
        let vibration = Vibration::vibration_of(settings)?;
        if share == Si::ZERO && vibration.is_none() {
            return Ok(None);
        }
        let rate = Si::saturating_from_num(settings.rate_hz);
        let inertia = settings.estimator.inertia;
        let inertia_per_tick2 = inertia.saturating_mul(rate).saturating_mul(rate);
        let apart = (settings.rate_hz / APART_HZ).clamp(1, u32::from(u16::MAX)) as u16;
        Ok(Some(Self {
            brake: stiffness(
                Field::ImpactMomentum,
                share.saturating_mul(inertia_per_tick2),
            )?,
            limit: largest_force(settings)?,
            apart,
            left: Force::zero(),
            outside: apart,
            vibration,
        }))
    }
}

/// A fraction divided by the soft stiffness `k_v`, as a compliance in rad/(N·m).
fn compliance<N: Number>(
    settings: &Settings,
    field: Field,
    share: Si,
) -> Result<Compliance<N>, SettingsError> {
    ratio::<N>(field, over(share, settings.k_soft)).map(Compliance)
}

/// Converts a fraction per millisecond to a fraction per tick (control period), at most 1. So the soft spring's offset changes at
/// the same speed at every control rate.
#[inline]
fn share_of_tick(settings: &Settings, per_ms: Si) -> Si {
    let per_s = per_ms.saturating_mul(const { Si::const_from_int(1000) });
    over(per_s, Si::saturating_from_num(settings.rate_hz)).min(Si::ONE)
}

fn augmentation<N: Number>(settings: &Settings) -> Result<Augmentation<N>, SettingsError> {
    let of_force = share_of_tick(settings, settings.limit_of_force);
    let of_penetration = share_of_tick(settings, settings.limit_of_penetration);
    Ok(Augmentation {
        of_ideal: ideal_step(settings)?,
        of_force: compliance(settings, Field::LimitOfForce, of_force)?,
        of_penetration: Ratio(ratio::<N>(Field::LimitOfPenetration, of_penetration)?),
    })
}

fn virtual_mass<N: Number>(settings: &Settings) -> Result<VirtualMass<N>, SettingsError> {
    let (filter, derived) = (&settings.filter, settings.derived());
    let total = derived
        .mass_per_tick2
        .saturating_add(filter.stiffness)
        .saturating_add(derived.filter_damping_per_tick)
        .saturating_add(derived.ground_damping_per_tick);
    // Twice the sum must fit, or the sum of products that drives the mass could saturate. An error names the largest part of the
    // sum.
    let (blamed, _) = [
        (Field::FilterStiffness, filter.stiffness),
        (Field::FilterDamping, derived.filter_damping_per_tick),
        (Field::FilterGroundDamping, derived.ground_damping_per_tick),
    ]
    .into_iter()
    .fold(
        (Field::FilterMass, derived.mass_per_tick2),
        |largest, part| if part.1 > largest.1 { part } else { largest },
    );
    stiffness::<N>(blamed, total.saturating_mul(Si::const_from_int(2)))?;
    let total = stiffness(blamed, total)?;
    // In a 16-bit or 8-bit format a soft coupling can round to 0, and nothing would move the mass.
    let coupling = stiffness(Field::FilterStiffness, filter.stiffness)?;
    if coupling == Stiffness::zero() {
        return Err(SettingsError::OutOfFormat {
            field: Field::FilterStiffness,
            value: filter.stiffness,
            format: N::NAME,
        });
    }
    Ok(VirtualMass {
        inertia: stiffness(Field::FilterMass, derived.mass_per_tick2)?,
        stiffness: coupling,
        damping: stiffness(Field::FilterDamping, derived.filter_damping_per_tick)?,
        total,
        by_total: Divisor::of(total),
    })
}

/// Gain from the error of the force to the offset's ideal step, `c/k_v` (equation (3.7) of the thesis) or `c/k_de`, chosen by
/// [`crate::IdealStep`]. `c` is the fraction of the step per tick, `k_v` the soft and `k_de` the desired stiffness.
fn ideal_step<N: Number>(settings: &Settings) -> Result<Compliance<N>, SettingsError> {
    let stiffness = match settings.ideal_step {
        IdealStep::Position => settings.k_soft,
        // The desired stiffness is above the soft one here: otherwise the law is a plain spring.
        IdealStep::Force => settings.k_desired,
    };
    let share = share_of_tick(settings, settings.step_of_ideal);
    ratio::<N>(Field::StepOfIdeal, over(share, stiffness)).map(Compliance)
}

/// Largest energy that a law stores: half of the number format's largest value, so that adding the work of one tick never
/// saturates.
fn energy_cap<N: Number>() -> Energy<N> {
    // In the 32-bit format 2^62 of 2^63: 16384 J. A narrower format gets half of its own largest value (16 bits: 4 of 8 J).
    [16384, 4, 1]
        .into_iter()
        .find_map(|joules| N::energy(Si::const_from_int(joules)).map(Energy))
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_offset_is_as_fast_at_every_rate() {
        let share = |rate_hz: u32, per_ms: Si| {
            let settings = Settings {
                rate_hz,
                ..Settings::default()
            };
            share_of_tick(&settings, per_ms)
        };
        // At 1, 8 and 0.5 kHz a tick is 1, 1/8 and 2 ms long.
        let odd = Si::lit("0.123456789");
        assert_eq!(share(1000, odd), odd, "to the bit");
        assert_eq!(share(8000, Si::lit("0.5")), Si::lit("0.0625"));
        assert_eq!(share(500, Si::lit("0.25")), Si::lit("0.5"));
        // The fraction per tick is never more than 1.
        assert_eq!(share(500, Si::lit("0.75")), Si::ONE);
        assert_eq!(share(1, Si::ONE), Si::ONE);
    }
}
