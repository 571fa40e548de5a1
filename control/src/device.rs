//! A description of the user's haptic device. The settings of energy guard and estimator, the encoder's count and the limits follow
//! from this description. [`OwnForce`] runs a force of any origin on the device.
//!
//! | field | range | an error of the value |
//! |---|---|---|
//! | `rate_hz` | 1 to 100,000 Hz | is **never safe**: in a slower tick the damping takes less energy than the guard counts |
//! | `inertia` | at least `max(force_limit, 0.76 N·m)/rate_hz²` | is safe: only the estimator uses it. A wrong value makes a stiff force shake |
//! | `damping` | 0 to 1,000 N·m·s/rad | is safe if the value is **too small** |
//! | `position` | one count plus twice `position_error`: up to 0.1 rad | is safe if the count is **too large** (too few counts per turn) |
//! | `position_error` | 0 to 0.05 rad | is safe if the value is **too large** |
//! | `force_limit` | 0 to below 128 N·m in 32 bits | is safe if the value is **too small**: the motor must give every force up to it |
//! | `delay`, `lag` | together at most one tick | is safe on **neither side**: 1 µs costs some 10 µW, half a tick joules per second |
//!
//! Units are those of a rotating device. For a linear device take m, N and kg with the same numbers.

use crate::estimator::EstimatorState;
use crate::law::Sample;
use crate::quotient::over;
use crate::{
    EstimatorSettings, Force, Guard, GuardSettings, Guarded, GuardedDevice, Number, Position,
    PositionSettings, Settings, SettingsError, Si, States, Stiffness,
};

/// The properties of a device from which guard, estimator, count and limits follow. The [module](self) has each field's range, and
/// says on which side an error is safe.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Device {
    /// Control rate, Hz: calls of the tick in a second.
    pub rate_hz: u32,
    /// Inertia of everything that moves with the device, without a hand, kg·m² (kg).
    pub inertia: Si,
    /// Viscous damping of the device alone, without a hand, as measured, N·m·s/rad (N·s/m). The guard relies on 0.8 of it.
    pub damping: Si,
    /// The encoder: angle (length) of one count.
    pub position: PositionSettings,
    /// Largest error of a measured position besides the rounding to counts, rad (m): an off-centre magnet, a sensor that is not
    /// linear.
    pub position_error: Si,
    /// Largest force that the motor gives, N·m (N).
    pub force_limit: Si,
    /// Time from reading the position until the new force begins to act, s.
    pub delay: Si,
    /// Mean time from then until the force acts, s. For a first-order drive it is the time constant.
    pub lag: Si,
}

impl Device {
    /// The properties that the guard's coefficients depend on.
    #[must_use]
    pub const fn guarded_device(&self) -> GuardedDevice {
        GuardedDevice {
            rate_hz: self.rate_hz,
            force_limit: self.force_limit,
            count: self.position.uncertainty(self.position_error),
        }
    }

    /// The energy guard's settings for this device, for one position reading per tick. Capacity, refill power, trusted fraction of
    /// the damping and over-speed limit are the shipped ones.
    #[must_use]
    pub fn guard_settings(&self) -> GuardSettings {
        GuardSettings {
            on: true,
            damping: self.damping,
            delay: self.delay,
            lag: self.lag,
            ..GuardSettings::default()
        }
    }

    /// The estimator's settings for this device, with the shipped bandwidth as far as the control rate allows it.
    #[must_use]
    pub fn estimator_settings(&self) -> EstimatorSettings {
        let rate = Si::saturating_from_num(self.rate_hz);
        let slowest = over(rate, const { Si::const_from_int(500) });
        let fastest = over(rate, const { Si::const_from_int(5) });
        EstimatorSettings {
            bandwidth_hz: EstimatorSettings::default()
                .bandwidth_hz
                .max(slowest)
                .min(fastest),
            inertia: self.inertia,
            damping: self.damping,
            delay_s: self.delay.saturating_add(self.lag),
        }
    }

    /// The energy guard for this device, with a full energy account.
    ///
    /// # Errors
    /// A value is out of its range.
    pub fn guard<N: Number>(&self) -> Result<Guarded<N>, SettingsError> {
        Guard::new(&self.guard_settings(), &self.guarded_device()).map(Guarded::new)
    }

    /// The estimator of this device's position and velocity.
    ///
    /// # Errors
    /// A value is out of its range.
    pub fn states<N: Number>(&self) -> Result<States<N>, SettingsError> {
        let estimator = self
            .estimator_settings()
            .estimator(self.rate_hz, self.force_limit)?;
        Ok(States::Estimated(estimator, EstimatorState::default()))
    }

    /// Estimator, limit and guard around a user-defined force.
    ///
    /// # Errors
    /// A value is out of its range.
    pub fn own_force<N: Number>(&self) -> Result<OwnForce<N>, SettingsError> {
        OwnForce::new(self, &self.guard_settings())
    }

    /// Converts a damping in N·m·s/rad to a force per displacement in a tick, for a damper in a user-defined force. `None` if the
    /// result does not fit the number format.
    #[must_use]
    pub fn damper<N: Number>(&self, damping: Si) -> Option<Stiffness<N>> {
        N::gain(damping.checked_mul(Si::saturating_from_num(self.rate_hz))?).map(Stiffness)
    }

    /// Converts a stiffness in N·m/rad to the number format, for a spring in a user-defined force. `None` if it does not fit.
    #[must_use]
    pub fn spring<N: Number>(&self, stiffness: Si) -> Option<Stiffness<N>> {
        N::gain(stiffness).map(Stiffness)
    }

    /// Makes a law's settings at least as cautious as this device requires. Rate, delay and lag become the device's, because an
    /// error to either side is unsafe. Count and position error become at least the device's, force limit and trusted damping at
    /// most the device's. Values that are already more cautious are kept.
    pub fn hold(&self, settings: &mut Settings) {
        let trusted = GuardSettings::default().share_of_damping;
        let count = &mut settings.position.count;
        *count = self.position.count.max(*count);
        let error = &mut settings.position_error;
        *error = self.position_error.max(*error);
        settings.rate_hz = self.rate_hz;
        settings.force_limit = settings.force_limit.min(self.force_limit);
        let guard = &mut settings.guard;
        guard.damping = guard.damping.min(self.damping);
        if guard.share_of_damping.saturating_mul(guard.damping)
            > trusted.saturating_mul(self.damping)
        {
            guard.share_of_damping = trusted;
        }
        guard.delay = self.delay;
        guard.lag = self.lag;
    }
}

/// A user-defined force on a [`Device`], with the estimator before it, and the limit and the energy guard after it.
///
/// ```text
/// position -> estimator -> own force -> limit -> guard -> force
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OwnForce<N: Number> {
    /// The source of position and velocity: the estimator.
    pub states: States<N>,
    /// The energy guard after the force.
    pub guard: Guarded<N>,
    limit: Force<N>,
    commanded: Force<N>,
}

impl<N: Number> OwnForce<N> {
    /// Estimator, limit and guard of a device, in the state at power-up, with the given guard settings. [`Device::guard_settings`]
    /// returns settings to start from.
    ///
    /// # Errors
    /// A value is out of its range.
    pub fn new(device: &Device, guard: &GuardSettings) -> Result<Self, SettingsError> {
        Ok(Self {
            guard: Guarded::new(Guard::new(guard, &device.guarded_device())?),
            states: device.states()?,
            limit: Force(N::saturating_signal(device.force_limit)),
            commanded: Force::zero(),
        })
    }

    /// Runs one control period. Takes the measured position `x`, and the force as a function of position and displacement per
    /// tick. The function gets position and displacement predicted for the time at which its force acts, and returns the force
    /// against `+x`. This method returns the force to command against `+x`.
    #[inline]
    pub fn tick(&mut self, x: Position<N>, force: impl FnOnce(Sample<N>) -> Force<N>) -> Force<N> {
        self.tick_with_change(x, None, force)
    }

    /// Same as [`OwnForce::tick`], for a guard with `change: Measured`. Also takes the position that was measured when the force
    /// changed; `None` if it was not measured.
    #[inline]
    pub fn tick_with_change(
        &mut self,
        x: Position<N>,
        at_change: Option<Position<N>>,
        force: impl FnOnce(Sample<N>) -> Force<N>,
    ) -> Force<N> {
        self.states.commanded(self.commanded);
        let wanted = force(self.states.sample(x)).within(self.limit);
        self.commanded = self.guard.tick(x, at_change, wanted);
        self.commanded
    }

    /// Reports the force that really was commanded, if a later stage reduced it.
    #[inline]
    pub fn commanded(&mut self, force: Force<N>) {
        self.commanded = force;
        self.guard.commanded(force);
    }

    /// Reports that the motor is off. [`OwnForce::resume`] must come before the next tick.
    pub fn switched_off(&mut self) {
        self.commanded = Force::zero();
        self.guard.switched_off();
    }

    /// Allows forces again after [`OwnForce::switched_off`] or an over-speed. The guard's account keeps its energy; position and
    /// velocity are forgotten.
    pub fn resume(&mut self) {
        self.guard = Guarded::new(self.guard.guard).resumed(&self.guard);
        self.states.forget();
        self.commanded = Force::zero();
    }
}
