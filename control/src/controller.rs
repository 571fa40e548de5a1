//! Makes a running control law from settings. The coefficients are computed once, the law's memory is kept beside them, and `tick`
//! runs one control period.

use crate::choices::{LawKind, OffsetUpdate, StatesKind};
use crate::coefficients::{Common, soft_damper};
use crate::estimator::EstimatorState;
use crate::law::kept::{
    Damped, DampedState, EnhancedSfa, EnhancedState, Fba, FbaState, Kept as _, Sfa, SfaState, Tdpa,
    TdpaState,
};
use crate::law::{Impact, Law, Sample, Spring, SpringState, View, YieldingSurface};
use crate::settings::Settings;
use crate::{Force, Guard, Guarded, Number, Position, SettingsError, States, Stiffness};

/// A law chosen at run time, with its memory. Each variant holds the immutable coefficients and the state that ticks change.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum AnyLaw<N: Number> {
    /// Virtual spring, with or without damping. The enhanced law also becomes this variant if the desired stiffness is at most the
    /// soft stiffness `k_v` (§3.1 of the thesis).
    Spring(Spring<N>, SpringState),
    /// Virtual spring with virtual damping, whose velocity comes from its own filter.
    Damped(Damped<N>, DampedState<N>),
    /// Time-domain passivity approach: reduces the force if the wall would give more energy than it took.
    Tdpa(Tdpa<N>, TdpaState<N>),
    /// Force bounding approach: limits the force to what the energy put in and the device's damping cover.
    Fba(Fba<N>, FbaState<N>),
    /// Successive force augmentation, original or continuous: a soft spring whose offset grows until the force is that of a stiff
    /// wall.
    Sfa(Sfa<N>, SfaState<N>),
    /// Enhanced successive force augmentation, with a virtual mass.
    Enhanced(EnhancedSfa<N>, EnhancedState<N>),
}

impl<N: Number> AnyLaw<N> {
    /// Validates the settings and computes the coefficients of the law that they choose.
    ///
    /// # Errors
    /// A setting is out of its range, or a coefficient does not fit the number format.
    pub fn new(settings: &Settings) -> Result<Self, SettingsError> {
        let common = Common::new(settings)?;
        let spring = |damping| Self::Spring(common.spring(damping), SpringState::default());
        Ok(match settings.law {
            LawKind::Spring => spring(Stiffness::zero()),
            LawKind::SpringDamper => match common.damped(settings)? {
                (spring, None) => Self::Spring(spring, SpringState::default()),
                (spring, Some(velocity)) => {
                    let law =
                        Damped::kept(settings.law, || Ok(crate::law::Damped { spring, velocity }))?;
                    Self::Damped(law, DampedState::default())
                }
            },
            LawKind::Tdpa => Self::Tdpa(
                Tdpa::kept(settings.law, || common.tdpa(settings))?,
                TdpaState::default(),
            ),
            LawKind::Fba => Self::Fba(
                Fba::kept(settings.law, || common.fba(settings))?,
                FbaState::default(),
            ),
            LawKind::Sfa => {
                let law = Sfa::kept(settings.law, || {
                    common.sfa(settings, OffsetUpdate::TurnInward)
                })?;
                Self::Sfa(law, SfaState::default())
            }
            LawKind::SfaContinuous => {
                let law = Sfa::kept(settings.law, || common.sfa(settings, OffsetUpdate::Inward))?;
                Self::Sfa(law, SfaState::default())
            }
            LawKind::EnhancedSfa if settings.is_plain_spring() => spring(soft_damper(settings)?),
            LawKind::EnhancedSfa => Self::Enhanced(
                EnhancedSfa::kept(settings.law, || common.enhanced(settings))?,
                EnhancedState::default(),
            ),
        })
    }

    /// Runs one control period: takes the position and displacement of the hand's point (HIP), returns the force that pushes it
    /// out.
    // Inlined: the law is called from two places (alone and in an environment), and a call costs at least fifteen instructions.
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

    /// Clears the law's memory, as after a motion outside the wall.
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

/// A control law with its stages. The states give the law position and velocity, the pulse at the touch adds to its force, and
/// the energy guard limits the sum.
///
/// ```text
/// penetration e -> states -> surface -> law -> pulse at the touch -> guard -> force
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Controller<N: Number> {
    /// The control law with its memory.
    pub law: AnyLaw<N>,
    /// The stage before the law, which gives position and velocity: measured or estimated.
    pub states: States<N>,
    /// The wall's surface, which gives way to a hand that overpowers the motor.
    pub surface: YieldingSurface<N>,
    /// Pulse and vibration that are added to the law's force at the touch; `None` if the settings have neither.
    pub impact: Option<Impact<N>>,
    /// The energy guard after the law; `None` if the settings switch it off.
    pub guard: Option<Guarded<N>>,
    /// The force commanded at the last tick, as changed by later stages such as a current limit.
    commanded: Force<N>,
}

impl<N: Number> Controller<N> {
    /// Makes the law with its stages in the state at power-up.
    ///
    /// # Errors
    /// A setting is out of its range, or a coefficient does not fit the number format.
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
        let mut controller = Self::of_parts(law, states, guard);
        controller.surface = YieldingSurface::surface_of(settings)?;
        controller.impact = Impact::pulse_of(settings)?;
        Ok(controller)
    }

    /// Makes a controller from a law, a source of position and velocity, and a guard, each already made from settings; without a
    /// pulse at the touch, and with a surface that never gives way.
    #[must_use]
    pub fn of_parts(law: AnyLaw<N>, states: States<N>, guard: Option<Guarded<N>>) -> Self {
        Self {
            law,
            states,
            surface: YieldingSurface::unyielding(),
            impact: None,
            guard,
            commanded: Force::zero(),
        }
    }

    /// The source of position and velocity that the settings choose: measured or estimated.
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

    /// Resets this controller to a copy of `fresh`, a new controller, when the motor's force is switched on (arming). Only the
    /// energy in the guard's account is kept.
    ///
    /// The copy is in place: a law has some hundreds of bytes, and a control interrupt has no time to copy them more often.
    pub fn resume(&mut self, fresh: &Self) {
        let before = self.guard.as_ref().map(Guarded::account);
        *self = *fresh;
        if let (Some(guard), Some(account)) = (&mut self.guard, before) {
            guard.resume(account);
        }
    }

    /// Runs one control period: takes the measured penetration `e` into the wall (positive inside), returns the force that pushes
    /// out.
    ///
    /// If a later stage changes that force, the caller must report the new force with [`Controller::commanded`].
    #[inline]
    pub fn tick(&mut self, e: Position<N>) -> Force<N> {
        self.tick_with_change(e, None)
    }

    /// Same as [`Controller::tick`], with a second measured penetration: `at_change`, measured when the previous tick's force
    /// began to act; `None` if it is not measured.
    #[inline]
    pub fn tick_with_change(&mut self, e: Position<N>, at_change: Option<Position<N>>) -> Force<N> {
        self.states.commanded(self.commanded);
        let sample = self.surface.from_surface(self.states.sample(e));
        let mut wanted = self.law.tick(sample);
        self.surface.give_way(sample, wanted);
        if let Some(impact) = &mut self.impact {
            wanted = impact.with_pulse_and_vibration(sample, wanted);
        }
        let force = match &mut self.guard {
            None => wanted,
            Some(guard) => guard.tick(e, at_change, wanted),
        };
        self.commanded = force;
        force
    }

    /// Reports the force that really was commanded, if a later stage changed the last tick's force. Estimator and guard then
    /// calculate with it.
    #[inline]
    pub fn commanded(&mut self, force: Force<N>) {
        self.commanded = force;
        if let Some(guard) = &mut self.guard {
            guard.commanded(force);
        }
    }

    /// Reports that the force is switched off, with or without a tick before: see [`Guard::switched_off`].
    ///
    /// [`Guard::switched_off`]: crate::Guard::switched_off
    pub fn switched_off(&mut self) {
        self.commanded = Force::zero();
        if let Some(guard) = &mut self.guard {
            guard.switched_off();
        }
    }

    /// The force commanded at the last tick, as changed by later stages such as a current limit.
    #[must_use]
    pub const fn last_commanded(&self) -> Force<N> {
        self.commanded
    }

    /// Whether the guard has switched the force off: for overspeed, or because the law requested a force at the end of the range of
    /// positions.
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
