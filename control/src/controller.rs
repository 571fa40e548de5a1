//! From settings to a running law: coefficients computed once, state beside them, one `tick`.

use crate::choices::{LawKind, OffsetUpdate, StatesKind};
use crate::coefficients::{Common, soft_damper};
use crate::estimator::EstimatorState;
use crate::law::{
    Damped, DampedState, EnhancedSfa, EnhancedState, Fba, FbaState, Law, Sample, Sfa, SfaState,
    Spring, SpringState, Tdpa, TdpaState, View,
};
use crate::settings::Settings;
use crate::validate::SettingsError;
use crate::{Force, Guard, Guarded, Number, Position, States, Stiffness};

/// A law chosen at run time, with its state. Each variant is an immutable configuration beside its memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AnyLaw<N: Number> {
    /// Virtual spring, with or without damping; also the enhanced law below `k_v` (§3.1).
    Spring(Spring<N>, SpringState),
    /// Virtual spring with virtual damping, whose velocity comes from its own filter.
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
        let common = Common::new(settings)?;
        let spring = |damping| Self::Spring(common.spring(damping), SpringState::default());
        Ok(match settings.law {
            LawKind::Spring => spring(Stiffness::zero()),
            LawKind::SpringDamper => match common.damped(settings)? {
                (spring, None) => Self::Spring(spring, SpringState::default()),
                (spring, Some(velocity)) => {
                    Self::Damped(Damped { spring, velocity }, DampedState::default())
                }
            },
            LawKind::Tdpa => Self::Tdpa(common.tdpa(settings)?, TdpaState::default()),
            LawKind::Fba => Self::Fba(common.fba(settings)?, FbaState::default()),
            LawKind::Sfa => {
                let law = common.sfa(settings, OffsetUpdate::TurnInward)?;
                Self::Sfa(law, SfaState::default())
            }
            LawKind::SfaContinuous => {
                let law = common.sfa(settings, OffsetUpdate::Inward)?;
                Self::Sfa(law, SfaState::default())
            }
            LawKind::EnhancedSfa if settings.is_plain_spring() => spring(soft_damper(settings)?),
            LawKind::EnhancedSfa => {
                Self::Enhanced(common.enhanced(settings)?, EnhancedState::default())
            }
        })
    }

    /// Runs one control period: takes where the HIP is and how it moves, returns the force pushing out.
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

    /// Clears all memory.
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

    /// The law's internal values after the last tick.
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
    /// The stage before the law.
    pub states: States<N>,
    /// The stage after the law.
    pub guard: Option<Guarded<N>>,
    /// The force commanded at the last tick, after every later stage that may change it.
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
        let law = AnyLaw::new(settings)?;
        Ok(Self::of_parts(law, states, guard))
    }

    /// A controller of a law, its source of states and its guard, each already made of its settings.
    #[must_use]
    pub fn of_parts(law: AnyLaw<N>, states: States<N>, guard: Option<Guarded<N>>) -> Self {
        Self {
            law,
            states,
            guard,
            commanded: Force::zero(),
        }
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

    /// Runs one control period: takes the sampled penetration `e = x - x_s` (positive inside), returns the force
    /// pushing out.
    ///
    /// If a later stage changes that force, [`Controller::commanded`] must follow.
    #[inline]
    pub fn tick(&mut self, e: Position<N>) -> Force<N> {
        self.tick_with_change(e, None)
    }

    /// Same as [`Controller::tick`], for a penetration that was also measured when the force changed since the last tick.
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
        if let Some(guard) = &mut self.guard {
            guard.commanded(force);
        }
    }

    /// The force is switched off, after the last tick or without one: [`Guard::switched_off`].
    ///
    /// [`Guard::switched_off`]: crate::Guard::switched_off
    pub fn switched_off(&mut self) {
        self.commanded = Force::zero();
        if let Some(guard) = &mut self.guard {
            guard.switched_off();
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

    /// Whether a position is so deep inside the wall, near the end of the position format, that the guard lets no
    /// force pass.
    #[must_use]
    pub fn is_beyond_reach(&self, e: Position<N>) -> bool {
        let guard = self.guard.as_ref();
        e > Position::zero() && guard.is_some_and(|guard| guard.is_beyond_edge(e))
    }

    /// The law's internal values after the last tick.
    pub fn view(&self) -> View<N> {
        self.law.view()
    }
}
