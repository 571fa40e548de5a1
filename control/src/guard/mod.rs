//! The energy guard: a bound on the energy that any hand can get out of a device, with any control law.
//!
//! It is a token bucket for energy at the hand's port, with one energy account that is full at power-up only. The account gains the
//! energy that the hand puts in, the energy that a trusted fraction of the device's own damping dissipates, and the energy of a
//! small refill power. The energy that the hand gets out is taken off. The force is bounded so that the account covers every
//! displacement that is not overspeed:
//!
//! ```text
//! E(n) = E(n-1) + f(n-1) Δx - s g Δx + c (|Δx| - δ)² + P T - κ g² - |g| δ/2      at most C, at least R(n-1)
//! |f(n)| <= (E(n) - R(n-1))/D,   R(n) = |f(n)| (s d + δ/2)
//! ```
//!
//! `E` is the energy in the account and `C` the most that it holds. `Δx` is the displacement in a tick. `f` is the force, and `g
//! = f(n-1) - f(n-2)` its last change. `s` is the fraction of a tick after which a force begins to act. `c` is the trusted
//! damping over the tick `T`, `P` the refill power. `κ = s (1-s)/4c` covers the energy that the device can gain between two
//! samples without being measured. `δ` is an encoder count, `d` the largest displacement in a tick, and `D = d + δ`. `R` is the
//! reserve for a force that still acts after the next sample. `docs/energy-guard.md` has the derivation, the theorem and the
//! remaining terms.
//!
//! A later stage that makes the force smaller (fading in, a limit, rounding to a current) must report the result to
//! [`Guard::commanded`]. Otherwise the account counts a force that never acted.

mod guarded;
mod settings;

pub use crate::choices::ChangeOfForce;
pub use crate::settings::GuardSettings;
pub(crate) use guarded::displacement;
pub use guarded::{FURTHEST_ANGLE, Guarded};
pub use settings::GuardedDevice;
pub(crate) use settings::quantum;

use crate::{Compliance, Energy, Force, Number, Position, Ratio, Stiffness};

/// The guard's coefficients. [`Guard::new`] ensures the conditions under which the energy bound holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guard<N: Number> {
    /// The most energy that the guard's account holds, which is also the energy at power-up.
    pub capacity: Energy<N>,
    /// The energy that the refill power adds to the account at every tick.
    pub refill: Energy<N>,
    /// The trusted damping of the device divided by the control period, rounded down.
    pub damping: Stiffness<N>,
    /// The largest measured displacement per tick that the guard accepts; a larger one is overspeed.
    pub furthest: Position<N>,
    /// Twice the largest error of a measured position (one encoder count if it has no other error), rounded up.
    pub count: Position<N>,
    /// Fraction of a displacement that passes under the old force: of the tick's displacement or, if the position at the change of
    /// force is measured, of the displacement after that measurement.
    pub late: Ratio<N>,
    /// The guard charges this value times the square of a change of force. The displacement under the old force can differ from the
    /// assumed fraction `late`, and the charge covers the energy of that difference. Rounded up.
    pub stray: Compliance<N>,
    /// The guard charges this distance times the size of a change of force, for position errors. It is half an encoder count and
    /// the errors of rounding.
    pub slack: Position<N>,
    /// Largest allowed force for each joule in the account: 1 over the sum of `furthest`, two counts and roundings, or less if
    /// the number format has no room for that force. Rounded down.
    pub per_reach: Stiffness<N>,
    /// Largest displacement over which a force still acts after the next sample, plus half an encoder count, rounded up.
    pub in_flight: Position<N>,
    /// This compliance times the square of a force is the most energy that overspeed can cost until the force is off, over any
    /// displacement. Rounded up.
    pub overrun: Compliance<N>,
}

/// The guard's memory. Its energy account is full at power-up only: switching the force on, a reset of the law or leaving the wall
/// does not fill it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GuardState<N: Number> {
    /// Energy in the account, which the hand may still get out, J.
    pub account: Energy<N>,
    /// The force of the last tick.
    pub force: Force<N>,
    /// The force of the tick before the last one.
    pub older: Force<N>,
}

/// Error: the device moved further in a tick than the guard accepts ([`Guard::furthest`]) or, on three axes, a force was requested
/// at the end of the range of positions. No force may follow, so the caller has to switch off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Overspeed;

impl<N: Number> Guard<N> {
    /// The guard's memory at power-up: a full energy account, no force.
    #[must_use]
    pub fn full(&self) -> GuardState<N> {
        GuardState {
            account: self.capacity,
            ..GuardState::default()
        }
    }

    /// Runs one control period with one measured position. Takes the displacement since the last tick (positive inward) and the
    /// force that the law requests. Returns the force that is allowed.
    ///
    /// # Errors
    /// Overspeed: the caller must command no force from now on.
    #[inline]
    pub fn tick(
        &self,
        state: &mut GuardState<N>,
        moved: Position<N>,
        wanted: Force<N>,
    ) -> Result<Force<N>, Overspeed> {
        self.step(state, moved, Position::zero(), wanted)
    }

    /// Same as [`Guard::tick`], with the position also measured when the force changed: `before_change` is how much of the
    /// displacement `moved` passed before that change.
    ///
    /// # Errors
    /// Same as [`Guard::tick`].
    #[cfg_attr(target_pointer_width = "64", inline(always))]
    #[cfg_attr(not(target_pointer_width = "64"), inline)]
    pub fn tick_with_change(
        &self,
        state: &mut GuardState<N>,
        moved: Position<N>,
        before_change: Position<N>,
        wanted: Force<N>,
    ) -> Result<Force<N>, Overspeed> {
        if before_change.max(Position::zero() - before_change) > self.furthest {
            return self.overrun(state);
        }
        self.step(state, moved, before_change, wanted)
    }

    /// Reports the force that was finally commanded, if a later stage made the allowed force smaller. A larger force would break
    /// the energy bound and is counted as the allowed force.
    #[inline]
    pub fn commanded(&self, state: &mut GuardState<N>, force: Force<N>) {
        state.force = force.within(state.force.modulus());
    }

    /// Reports that the force is switched off and that no tick follows.
    ///
    /// After a tick that commands no force, only the older force still acts, for at most the delay of a change. The reserve for
    /// that force is taken off the account. If no tick ended the force, it is unknown how long it acted. But the account covered
    /// every displacement, so setting the account to zero is safe.
    #[cold]
    pub fn switched_off(&self, state: &mut GuardState<N>) {
        let account = if state.force == Force::zero() {
            state.account.minus_fitting(self.reserve(state.older))
        } else {
            state.account.min(Energy::zero())
        };
        *state = GuardState {
            account,
            ..GuardState::default()
        };
    }

    #[inline(always)]
    fn step(
        &self,
        state: &mut GuardState<N>,
        moved: Position<N>,
        before_change: Position<N>,
        wanted: Force<N>,
    ) -> Result<Force<N>, Overspeed> {
        let distance = moved.max(Position::zero() - moved);
        if distance > self.furthest {
            return self.overrun(state);
        }
        if state.account < Energy::zero() {
            return Ok(self.make_up(state, distance));
        }
        let reserve = self.reserve(state.force);
        let account = self
            .booked(state, moved, distance, before_change)
            .min(self.capacity);
        // The last force was chosen so that the account keeps the reserve after any displacement that is not overspeed. The sum
        // takes the worst case of each of its terms, so the sum can be lower than the reserve. Both are lower bounds of the true
        // energy, and the larger one counts.
        let free = account.minus_fitting(reserve).max(Energy::zero());
        let limit = self.largest_force(free);
        let force = wanted.min(limit).max(Force::zero() - limit);
        *state = GuardState {
            account: free.plus_fitting(reserve),
            force,
            older: state.force,
        };
        Ok(force)
    }

    /// The account's energy after a tick's work, charges and refill, before it is limited to the capacity.
    ///
    /// No sum overflows. Forces and displacements are at most a quarter of their format's range, so each product below is at most
    /// an eighth of the range of energies. The account is at most a quarter of that range.
    #[inline(always)]
    pub fn booked(
        &self,
        state: &GuardState<N>,
        moved: Position<N>,
        distance: Position<N>,
        before_change: Position<N>,
    ) -> Energy<N> {
        let (grown, shrunk) = (state.force - state.older, state.older - state.force);
        // Each force counts over its own part of the displacement. The true part under the older force may differ from the assumed
        // one, and the change of force is charged for the worst difference. That difference has the sign of the change, so the
        // product never adds energy.
        let on = moved - before_change;
        let under_older = before_change + self.late.of_and_fitting(on, self.stray, grown);
        state
            .account
            .plus_fitting(self.refill)
            .plus_fitting(state.force * moved)
            .plus_fitting(shrunk * under_older)
            .plus_fitting(grown.min(shrunk) * self.slack)
            .plus_fitting(self.damped(distance))
    }

    /// Energy that the trusted damping dissipated over a measured distance, which can be up to an encoder count longer than the
    /// true one.
    #[inline(always)]
    fn damped(&self, distance: Position<N>) -> Energy<N> {
        let surely = (distance - self.count).max(Position::zero());
        (self.damping * surely).down_fitting() * surely
    }

    /// The most energy that a force may still cost after the next sample, until another force replaces it. The account keeps this
    /// energy in reserve.
    #[inline(always)]
    #[must_use]
    pub fn reserve(&self, force: Force<N>) -> Energy<N> {
        force.modulus_fitting() * self.in_flight
    }

    /// The largest force whose work over the largest displacement per tick is covered by this energy, which must not be negative.
    ///
    /// It is the quotient of energy and displacement. Counting the device's damping too would need a square root, and is left out.
    /// The largest force is in proportion to the energy left. So the wall becomes softer as the account empties, and does not end
    /// suddenly.
    #[inline(always)]
    #[must_use]
    pub fn largest_force(&self, free: Energy<N>) -> Force<N> {
        (self.per_reach * free.digits_fitting()).down_fitting()
    }

    /// Adds refill and damping energy to an account that overspeed left negative. No force is allowed meanwhile, so no energy is
    /// lost.
    #[cold]
    fn make_up(&self, state: &mut GuardState<N>, distance: Position<N>) -> Force<N> {
        *state = GuardState {
            account: (state.account + self.refill + self.damped(distance)).min(self.capacity),
            ..GuardState::default()
        };
        Force::zero()
    }

    /// Overspeed: takes from the account the largest possible loss under the last two forces until the force is off.
    #[cold]
    fn overrun(&self, state: &mut GuardState<N>) -> Result<Force<N>, Overspeed> {
        let size = state.force.modulus().max(state.older.modulus());
        let lost = size * (self.overrun * size + Position::quantum());
        *state = GuardState {
            account: state.account - lost,
            ..GuardState::default()
        };
        Err(Overspeed)
    }
}

#[cfg(test)]
mod tests;
