//! Checks settings. An error refuses the settings. A warning names a passivity bound that the settings exceed, or a weak guard
//! setting, and the consequence.

use crate::refusal::{Field, SettingsError, Warning};

use crate::{Force, GuardedDevice, LawKind, Number, Regulate, Settings, Si, StatesKind};

/// Stiffness-like quantities that depend on several settings, computed once. All are in N·m/rad (N/m) and saturate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Derived {
    /// Critical stiffness `k_c = 2 c_i/T` of the device damping `c_i` and the control period `T`.
    pub k_critical: Si,
    /// Virtual mass over the squared control period: `m/T²`.
    pub mass_per_tick2: Si,
    /// Damping between hand and virtual mass over the control period: `c_f/T`.
    pub filter_damping_per_tick: Si,
    /// Damping of the virtual mass to ground over the control period: `c_env/T`.
    pub ground_damping_per_tick: Si,
    /// Device damping over the control period: `c_i/T`.
    pub device_damping_per_tick: Si,
    /// Virtual damping over the control period: `B/T`.
    pub virtual_damping_per_tick: Si,
}

impl Settings {
    /// Computes the critical stiffness, and dampings and inertia over the control period, from the settings.
    #[must_use]
    #[inline]
    pub fn derived(&self) -> Derived {
        let rate = Si::saturating_from_num(self.rate_hz);
        let per_tick = |damping: Si| damping.saturating_mul(rate);
        Derived {
            k_critical: per_tick(self.device_damping).saturating_mul(Si::const_from_int(2)),
            mass_per_tick2: per_tick(per_tick(self.filter.mass)),
            filter_damping_per_tick: per_tick(self.filter.damping),
            ground_damping_per_tick: per_tick(self.filter.ground_damping),
            device_damping_per_tick: per_tick(self.device_damping),
            virtual_damping_per_tick: per_tick(self.virtual_damping),
        }
    }

    /// Whether the enhanced law becomes a plain spring, with a damper, with these settings: the desired stiffness is at most the
    /// soft stiffness `k_v` (thesis §3.1).
    #[must_use]
    pub fn is_plain_spring(&self) -> bool {
        self.law == LawKind::EnhancedSfa && self.k_desired <= self.k_soft
    }

    /// Checks every setting against its physical range. [`crate::Controller::new`] checks whether values fit the number format.
    ///
    /// # Errors
    /// The first setting that is out of range.
    #[inline]
    pub fn validate(&self) -> Result<(), SettingsError> {
        self.check_ranges()?;
        self.filter.check_ranges()?;
        self.estimator.check_ranges()?;
        self.guard.check_ranges()?;
        self.velocity.check_ranges()?;
        self.impact.check_ranges()?;
        if self.law == LawKind::SpringDamper {
            self.velocity.validate(self.rate_hz)?;
        }
        if self.law == LawKind::EnhancedSfa
            && !self.is_plain_spring()
            && self.regulate == Regulate::MassCompensated
            && self.k_desired >= self.filter.stiffness
        {
            return Err(SettingsError::NoCompensation {
                k_desired: self.k_desired,
                k_filter: self.filter.stiffness,
            });
        }
        if self.states == StatesKind::Estimated {
            self.estimator.validate(self.rate_hz, self.force_limit)?;
            self.impact.validate(self.rate_hz)?;
        }
        if self.guard.on {
            self.guard.validate(&self.guarded_device())?;
        }
        Ok(())
    }

    /// The properties of the device that the guard's coefficients depend on.
    #[must_use]
    pub fn guarded_device(&self) -> GuardedDevice {
        GuardedDevice {
            rate_hz: self.rate_hz,
            force_limit: self.force_limit,
            count: self.position.uncertainty(self.position_error),
        }
    }

    /// The warnings about these settings with the chosen control law, and about the energy guard if it is on.
    pub fn warnings(&self) -> impl Iterator<Item = Warning> {
        let derived = self.derived();
        let half = const { Si::lit("0.5") };
        let augments = matches!(
            self.law,
            LawKind::Sfa | LawKind::SfaContinuous | LawKind::EnhancedSfa
        ) && !self.is_plain_spring();
        let filters = self.law == LawKind::EnhancedSfa && !self.is_plain_spring();
        let observes = self.law == LawKind::Tdpa || filters;
        let bound = (derived
            .device_damping_per_tick
            .saturating_sub(derived.filter_damping_per_tick)
            .saturating_sub(derived.virtual_damping_per_tick))
        .saturating_mul(Si::const_from_int(2));
        let ground = self.k_soft.saturating_mul(half);
        let guard = if self.guard.on {
            self.guard.warnings(&self.guarded_device())
        } else {
            [None; 2]
        };
        [
            (augments && self.k_soft > derived.k_critical).then_some(Warning::SoftAboveCritical {
                k_soft: self.k_soft,
                k_critical: derived.k_critical,
            }),
            (filters && self.filter.stiffness > bound).then_some(Warning::CouplingAboveBound {
                k_filter: self.filter.stiffness,
                bound,
            }),
            (filters && derived.ground_damping_per_tick < ground).then_some(
                Warning::GroundDampingBelowBound {
                    ground_damping_per_tick: derived.ground_damping_per_tick,
                    bound: ground,
                },
            ),
            (observes && self.observer == crate::ObserverForm::Thesis)
                .then_some(Warning::ThesisObserver),
            (self.law == LawKind::Tdpa && self.states == crate::StatesKind::Estimated)
                .then_some(Warning::ObservesEstimates),
            (filters
                && self.observer == crate::ObserverForm::Exact
                && self.energy_credit > Si::ZERO)
                .then_some(Warning::EnergyCredit {
                    credit: self.energy_credit,
                }),
        ]
        .into_iter()
        .chain(guard)
        .flatten()
    }
}

/// Largest force that a law commands.
pub(crate) fn largest_force<N: Number>(settings: &Settings) -> Result<Force<N>, SettingsError> {
    N::signal(settings.force_limit)
        .map(Force)
        .ok_or(SettingsError::OutOfFormat {
            field: Field::ForceLimit,
            value: settings.force_limit,
            format: N::NAME,
        })
}

/// Converts a coefficient to a gain (stiffness) of the number format `N`, or returns the error that names the coefficient's
/// setting.
pub(crate) fn gain<N: Number>(field: Field, value: Si) -> Result<N::Gain, SettingsError> {
    N::gain(value).ok_or(SettingsError::OutOfFormat {
        field,
        value,
        format: N::NAME,
    })
}

/// Converts a coefficient to a ratio or compliance of the number format `N`, or returns the error that names the coefficient's
/// setting.
pub(crate) fn ratio<N: Number>(field: Field, value: Si) -> Result<N::Ratio, SettingsError> {
    N::ratio(value).ok_or(SettingsError::OutOfFormat {
        field,
        value,
        format: N::NAME,
    })
}
