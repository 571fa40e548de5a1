//! From settings to a running law: coefficients computed once, state beside them, one `tick`.

use crate::choices::{IdealStep, LawKind, OffsetUpdate, Regulate, StatesKind};
use crate::estimator::EstimatorState;
use crate::filter::VirtualMass;
use crate::law::{
    Augmentation, Damped, DampedState, EnhancedSfa, EnhancedState, Fba, FbaState, Law, Sample, Sfa,
    SfaState, Spring, SpringState, Tdpa, TdpaState, View,
};
use crate::quotient::over;
use crate::settings::{Settings, Si};
use crate::validate::{Field, SettingsError, gain, ratio};
use crate::{
    Compliance, Divisor, Energy, Force, Guard, Guarded, Number, ObserverForm, Position, Ratio,
    States, Stiffness,
};

/// A law chosen at run time, with its state. Each variant is an immutable configuration beside its memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AnyLaw<N: Number> {
    /// Virtual spring, with or without damping; also the enhanced law below `k_v` (§3.1).
    Spring(Spring<N>, SpringState),
    /// Virtual spring with virtual damping and a velocity of its own.
    Damped(Damped<N>, DampedState<N>),
    /// Time-domain passivity approach.
    Tdpa(Tdpa<N>, TdpaState<N>),
    /// Force bounding approach.
    Fba(Fba<N>, FbaState<N>),
    /// Successive force augmentation, original or continuous.
    Sfa(Sfa<N>, SfaState<N>),
    /// Enhanced successive force augmentation.
    Enhanced(EnhancedSfa<N>, EnhancedState<N>),
}

impl<N: Number> AnyLaw<N> {
    /// Validates the settings and computes the coefficients of their law.
    ///
    /// # Errors
    /// A setting out of its range, or a coefficient that does not fit the number format.
    pub fn new(settings: &Settings) -> Result<Self, SettingsError> {
        settings.validate()?;
        let derived = settings.derived();
        let stiffness = |field, value| gain::<N>(field, value).map(Stiffness);
        let desired = stiffness(Field::KDesired, settings.k_desired)?;
        let limit =
            N::signal(settings.force_limit)
                .map(Force)
                .ok_or(SettingsError::OutOfFormat {
                    field: Field::ForceLimit,
                    value: settings.force_limit,
                    format: N::NAME,
                })?;
        let device_damping = || stiffness(Field::DeviceDamping, derived.device_damping_per_tick);
        let energy_cap = energy_cap::<N>();
        let with_damping = |damping| Spring {
            desired,
            damping,
            limit,
        };
        let spring = |damping| Self::Spring(with_damping(damping), SpringState::default());
        Ok(match settings.law {
            LawKind::Spring => spring(Stiffness::zero()),
            LawKind::SpringDamper => {
                let damping = stiffness(Field::VirtualDamping, derived.virtual_damping_per_tick)?;
                let (rate, count) = (settings.rate_hz, settings.position.count);
                match settings.velocity.velocity(rate, count)? {
                    None => spring(damping),
                    Some(velocity) => {
                        let spring = with_damping(damping);
                        Self::Damped(Damped { spring, velocity }, DampedState::default())
                    }
                }
            }
            LawKind::Tdpa => {
                let device_damping = if settings.count_device_damping {
                    device_damping()?
                } else {
                    Stiffness::zero()
                };
                let law = Tdpa {
                    desired,
                    observer: settings.observer,
                    device_damping,
                    limit,
                    energy_cap,
                };
                Self::Tdpa(law, TdpaState::default())
            }
            LawKind::Fba => {
                let damping = device_damping()?;
                let law = Fba {
                    desired,
                    device_damping: damping,
                    // Of the damping as stored, not as set: the bound must not count on what the observer does not count.
                    bound: Stiffness(N::root_of_four(damping.0)),
                    limit,
                    energy_cap,
                };
                Self::Fba(law, FbaState::default())
            }
            LawKind::Sfa => Self::sfa(settings, OffsetUpdate::TurnInward, desired, limit)?,
            LawKind::SfaContinuous => Self::sfa(settings, OffsetUpdate::Inward, desired, limit)?,
            LawKind::EnhancedSfa if settings.is_plain_spring() => spring(Stiffness::zero()),
            LawKind::EnhancedSfa => Self::enhanced(settings, desired, limit, energy_cap)?,
        })
    }

    fn sfa(
        settings: &Settings,
        update: OffsetUpdate,
        desired: Stiffness<N>,
        limit: Force<N>,
    ) -> Result<Self, SettingsError> {
        let derived = settings.derived();
        // (2.14a) with k_c below k_v would pull the offset the wrong way: such a device needs no augmentation.
        let step = over(derived.k_critical, settings.k_soft)
            .saturating_sub(Si::ONE)
            .max(Si::ZERO);
        let law = Sfa {
            desired,
            soft: Stiffness(gain::<N>(Field::KSoft, settings.k_soft)?),
            gain: Ratio(ratio::<N>(Field::DeviceDamping, step)?),
            compliance: Compliance(ratio::<N>(Field::KSoft, over(Si::ONE, settings.k_soft))?),
            update,
            first_contact: settings.first_contact,
            limit,
        };
        Ok(Self::Sfa(law, SfaState::default()))
    }

    fn enhanced(
        settings: &Settings,
        desired: Stiffness<N>,
        limit: Force<N>,
        energy_cap: Energy<N>,
    ) -> Result<Self, SettingsError> {
        let derived = settings.derived();
        let filter = &settings.filter;
        let stiffness = |field, value| gain::<N>(field, value).map(Stiffness);
        let compliance =
            |field, share| ratio::<N>(field, over(share, settings.k_soft)).map(Compliance);
        // (3.5): 1/(1/k_de - 1/k_f) = k_de k_f/(k_f - k_de); validate has seen to k_de < k_f.
        let target = match settings.regulate {
            Regulate::MassCompensated => over(
                settings.k_desired.saturating_mul(filter.stiffness),
                filter.stiffness.saturating_sub(settings.k_desired),
            ),
            Regulate::Mass | Regulate::Hip => settings.k_desired,
        };
        let total = derived
            .mass_per_tick2
            .saturating_add(filter.stiffness)
            .saturating_add(derived.filter_damping_per_tick)
            .saturating_add(derived.ground_damping_per_tick);
        // Twice the sum must fit, or the sum of products in the drive could saturate; its largest part is what to mend.
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
        stiffness(blamed, total.saturating_mul(Si::const_from_int(2)))?;
        let total = stiffness(blamed, total)?;
        // In a narrow format a soft coupling can round to nothing, and the mass would have nothing that moves it.
        let coupling = stiffness(Field::FilterStiffness, filter.stiffness)?;
        if coupling == Stiffness::zero() {
            return Err(SettingsError::OutOfFormat {
                field: Field::FilterStiffness,
                value: filter.stiffness,
                format: N::NAME,
            });
        }
        // The published observer reports the sampling leak as a gain, and so lends what it needs by itself.
        let lent = match settings.observer {
            ObserverForm::Exact => settings.energy_credit,
            ObserverForm::Thesis => Si::ZERO,
        };
        let law = EnhancedSfa {
            desired,
            target: stiffness(Field::KDesired, target)?,
            soft: stiffness(Field::KSoft, settings.k_soft)?,
            compliance: compliance(Field::KSoft, Si::ONE)?,
            augmentation: Augmentation {
                of_ideal: ideal_step(settings)?,
                of_force: compliance(Field::LimitOfForce, settings.limit_of_force)?,
                of_penetration: Ratio(ratio::<N>(
                    Field::LimitOfPenetration,
                    settings.limit_of_penetration,
                )?),
            },
            regulate: settings.regulate,
            update: settings.offset_update,
            observer: settings.observer,
            first_contact: settings.first_contact,
            mass: VirtualMass {
                inertia: stiffness(Field::FilterMass, derived.mass_per_tick2)?,
                stiffness: coupling,
                damping: stiffness(Field::FilterDamping, derived.filter_damping_per_tick)?,
                total,
                by_total: Divisor::of(total),
            },
            by_coupling: Divisor::of(coupling),
            series: Divisor::of(stiffness(
                Field::FilterStiffness,
                filter.stiffness.saturating_add(settings.k_soft),
            )?),
            // A loan above the cap would break the books of the narrow formats (0.5 of 8 J and the like).
            credit: N::energy(lent)
                .map(Energy)
                .filter(|credit| *credit <= energy_cap)
                .ok_or(SettingsError::OutOfFormat {
                    field: Field::EnergyCredit,
                    value: settings.energy_credit,
                    format: N::NAME,
                })?,
            energy_cap,
            limit,
        };
        Ok(Self::Enhanced(law, EnhancedState::default()))
    }

    /// One control period: where the HIP is and how it moves, to the force pushing out.
    // A law called from two places, by itself and in an environment, would be a call in both, and another fifteen instructions and more.
    #[inline(always)]
    pub fn tick(&mut self, e: Sample<N>) -> Force<N> {
        match self {
            Self::Spring(law, state) => law.tick(state, e),
            Self::Damped(law, state) => law.tick(state, e),
            Self::Tdpa(law, state) => law.tick(state, e),
            Self::Fba(law, state) => law.tick(state, e),
            Self::Sfa(law, state) => law.tick(state, e),
            Self::Enhanced(law, state) => law.tick(state, e),
        }
    }

    /// All memory is new.
    pub fn forget(&mut self) {
        match self {
            Self::Spring(_, state) => *state = SpringState::default(),
            Self::Damped(_, state) => *state = DampedState::default(),
            Self::Tdpa(_, state) => *state = TdpaState::default(),
            Self::Fba(_, state) => *state = FbaState::default(),
            Self::Sfa(_, state) => *state = SfaState::default(),
            Self::Enhanced(_, state) => *state = EnhancedState::default(),
        }
    }

    /// The inside after the last tick.
    pub fn view(&self) -> View<N> {
        match self {
            Self::Spring(law, state) => law.view(state),
            Self::Damped(law, state) => law.view(state),
            Self::Tdpa(law, state) => law.view(state),
            Self::Fba(law, state) => law.view(state),
            Self::Sfa(law, state) => law.view(state),
            Self::Enhanced(law, state) => law.view(state),
        }
    }
}

/// A law, what it is told of the device, and what its force may be.
///
/// ```text
/// e -> states -> law -> guard -> force
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Controller<N: Number> {
    /// The law.
    pub law: AnyLaw<N>,
    /// The stage before it.
    pub states: States<N>,
    /// The stage after it.
    pub guard: Option<Guarded<N>>,
    /// What was commanded at the last tick, after every stage that may change it.
    commanded: Force<N>,
}

impl<N: Number> Controller<N> {
    /// The law with its stages, at power-up.
    ///
    /// # Errors
    /// A setting out of its range, or a coefficient that does not fit the number format.
    #[cold]
    #[inline(never)]
    pub fn new(settings: &Settings) -> Result<Self, SettingsError> {
        let states = Self::states_of(settings)?;
        let guard = if settings.guard.on {
            let guard = Guard::new(&settings.guard, &settings.guarded_device())?;
            Some(Guarded::new(guard))
        } else {
            None
        };
        Ok(Self {
            law: AnyLaw::new(settings)?,
            states,
            guard,
            commanded: Force::zero(),
        })
    }

    /// The stage before the law.
    pub(crate) fn states_of(settings: &Settings) -> Result<States<N>, SettingsError> {
        Ok(match settings.states {
            StatesKind::Measured => States::default(),
            StatesKind::Estimated => {
                let estimator = settings
                    .estimator
                    .estimator(settings.rate_hz, settings.force_limit)?;
                States::Estimated(estimator, EstimatorState::default())
            }
        })
    }

    /// A law as it was made takes the place of this one, for the next arming: all memory is new but the guard's account.
    ///
    /// In place, since a law is some hundred bytes and a control interrupt has no time to carry them about.
    pub fn resume(&mut self, fresh: &Self) {
        let before = self.guard.as_ref().map(Guarded::account);
        *self = *fresh;
        if let (Some(guard), Some(account)) = (&mut self.guard, before) {
            guard.resume(account);
        }
    }

    /// One control period: the sampled penetration `e = x - x_s` (positive inside) to the force pushing out.
    ///
    /// If a later stage changes that force, [`Controller::commanded`] must follow.
    #[inline]
    pub fn tick(&mut self, e: Position<N>) -> Force<N> {
        self.tick_with_change(e, None)
    }

    /// The same where the penetration was also measured when the force changed since the last tick.
    #[inline]
    pub fn tick_with_change(&mut self, e: Position<N>, at_change: Option<Position<N>>) -> Force<N> {
        self.states.commanded(self.commanded);
        let wanted = self.law.tick(self.states.sample(e));
        let force = match &mut self.guard {
            None => wanted,
            Some(guard) => guard.tick(e, at_change, wanted),
        };
        self.commanded = force;
        force
    }

    /// What became of the last tick's force, where a later stage changed it: estimator and guard then count with that.
    #[inline]
    pub fn commanded(&mut self, force: Force<N>) {
        self.commanded = force;
        if let Some(Guarded { guard, state, .. }) = &mut self.guard {
            guard.commanded(state, force);
        }
    }

    /// What became of the last tick's force.
    #[must_use]
    pub const fn last_commanded(&self) -> Force<N> {
        self.commanded
    }

    /// Whether the guard has switched the force off for overspeed.
    #[must_use]
    pub fn tripped(&self) -> bool {
        self.guard.as_ref().is_some_and(|guard| guard.tripped)
    }

    /// The inside after the last tick.
    pub fn view(&self) -> View<N> {
        self.law.view()
    }
}

/// `c/k_v` (3.7) or `c/k_de`.
fn ideal_step<N: Number>(settings: &Settings) -> Result<Compliance<N>, SettingsError> {
    let stiffness = match settings.ideal_step {
        IdealStep::Position => settings.k_soft,
        // Above k_soft here: below it the law is a plain spring.
        IdealStep::Force => settings.k_desired,
    };
    ratio::<N>(Field::StepOfIdeal, over(settings.step_of_ideal, stiffness)).map(Compliance)
}

/// Largest energy that a law stores: a quarter of the format, so that adding one tick's work can never saturate.
fn energy_cap<N: Number>() -> Energy<N> {
    // 2^62 of 2^63 in the 32-bit format: 16384 J. Formats that cannot say so (16 bits: ±8 J) get a quarter of theirs.
    [16384, 4, 1]
        .into_iter()
        .find_map(|joules| N::energy(Si::const_from_int(joules)).map(Energy))
        .unwrap_or_default()
}
