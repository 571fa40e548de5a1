//! The energy guard: a bound on what any hand can get out of a device, whatever the law before it does.
//!
//! A token bucket for energy at the hand's port. One account, full once at power-up, takes in what the hand puts in, what a
//! trusted share of the device's own damping takes out of the motion, and a small refill; it pays what the hand gets out. The
//! force is bounded so that every displacement that is not overspeed can be paid:
//!
//! ```text
//! E(n) = E(n-1) + f(n-1) Δx - s g Δx + c (|Δx| - δ)² + P T - κ g² - |g| δ/2      at most C, at least R(n-1)
//! |f(n)| <= (E(n) - R(n-1))/D,   R(n) = |f(n)| (s d + δ/2)
//! ```
//!
//! `g = f(n-1) - f(n-2)` is the last change of force, `s` the share of a tick after which a force begins to act, `κ = s (1-s)/4c`
//! what the device can make of that unseen between two samples, `δ` a count, `d` the furthest displacement of a tick, `D = d + δ`,
//! and `R` the reserve for a force that acts on after the next sample. Derivation, theorem and what remains:
//! `docs/energy-guard.md`.
//!
//! What makes the force smaller afterwards (fading in, a limit, rounding to a current) is told to [`Guard::commanded`], or the
//! account is of a force that never acted.

mod guarded;
mod settings;

pub use crate::choices::ChangeOfForce;
pub use crate::settings::GuardSettings;
pub use guarded::Guarded;
pub use settings::GuardedDevice;
pub(crate) use settings::quantum;

use crate::{Compliance, Energy, Force, Number, Position, Ratio, Stiffness};

/// The guard's coefficients; what each must satisfy is what [`Guard::new`] sees to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guard<N: Number> {
    /// `C`: the most that the account holds, which is also what it has at power-up.
    pub capacity: Energy<N>,
    /// `P T`: the energy that the account gains at every tick.
    pub refill: Energy<N>,
    /// `c`: the trusted damping over a tick, rounded down.
    pub damping: Stiffness<N>,
    /// The longest measured displacement that is not overspeed.
    pub furthest: Position<N>,
    /// `δ`: twice the largest error of a measured position, rounded up.
    pub count: Position<N>,
    /// The part of a displacement that passes under the old force where nothing else is known.
    pub late: Ratio<N>,
    /// How far a newton-metre of change pays for straying from that part, rounded up.
    pub stray: Compliance<N>,
    /// What every change of force is charged for anyway: half a count and what rounding leaves out.
    pub slack: Position<N>,
    /// `1/D`, rounded down.
    pub per_reach: Stiffness<N>,
    /// How far the device can move under a force that is on its way, and half a count, rounded up.
    pub in_flight: Position<N>,
    /// `(1 + s)/4c`: the most that a newton-metre can have lost, over any displacement, until it is off; rounded up.
    pub overrun: Compliance<N>,
}

/// The guard's memory. It starts full, once: arming, a reset of the law or leaving the wall are no reason for another.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct GuardState<N: Number> {
    /// Energy that the hand may still get out, J.
    pub account: Energy<N>,
    /// The force of the last tick.
    pub force: Force<N>,
    /// The force of the tick before it.
    pub older: Force<N>,
}

/// The device moved further in a tick than the account answers for, or, of a stage that knows where it is, to where positions end. No
/// force may follow; the caller has to switch off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Overspeed;

impl<N: Number> Guard<N> {
    /// Memory at power-up: a full account, no force.
    #[must_use]
    pub fn full(&self) -> GuardState<N> {
        GuardState {
            account: self.capacity,
            ..GuardState::default()
        }
    }

    /// Runs one control period with one position a period: takes the displacement since the last tick (inward
    /// positive) and the force that the law wants, returns the force that is allowed.
    ///
    /// # Errors
    /// Overspeed: from now on the force is 0.
    #[inline]
    pub fn tick(
        &self,
        state: &mut GuardState<N>,
        moved: Position<N>,
        wanted: Force<N>,
    ) -> Result<Force<N>, Overspeed> {
        self.step(state, moved, Position::zero(), wanted)
    }

    /// Same as [`Guard::tick`], with the position also taken when the force changed: `before_change` is the part of `moved`
    /// that came before.
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

    /// The force that was commanded in the end, where something made the guarded one smaller. A larger one would be a promise
    /// broken, and counts as the guarded one.
    #[inline]
    pub fn commanded(&self, state: &mut GuardState<N>, force: Force<N>) {
        state.force = force.within(state.force.modulus());
    }

    /// The force is switched off, and no tick follows.
    ///
    /// After a tick that commands nothing, only the older force still acts, no longer than a change takes, and its
    /// reserve pays for that. If no tick ended the force, it is unknown how long it acted; but every displacement was
    /// paid for, so an empty account answers for it.
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
        // The last force was chosen so that the reserve is left after any displacement that is not overspeed: where the books,
        // which take the worst of each part by itself, say less, this says more, and both are true.
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

    /// The account after a tick.
    ///
    /// No sum overflows. Forces and displacements are at most a quarter of their format, so each product below is at
    /// most an eighth of an energy's, and the account is at most a quarter.
    #[inline(always)]
    pub fn booked(
        &self,
        state: &GuardState<N>,
        moved: Position<N>,
        distance: Position<N>,
        before_change: Position<N>,
    ) -> Energy<N> {
        let (grown, shrunk) = (state.force - state.older, state.older - state.force);
        // Each force over its own part of the way, and a change over as much more as pays best for who strays from it: the sign
        // of the second part is that of the change, so that its product is never gained.
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

    /// Energy that the trusted damping took. A measured displacement is up to a count longer than the true one.
    #[inline(always)]
    fn damped(&self, distance: Position<N>) -> Energy<N> {
        let surely = (distance - self.count).max(Position::zero());
        (self.damping * surely).down_fitting() * surely
    }

    /// The most that a force may still cost after the next sample, before another replaces it.
    #[inline(always)]
    #[must_use]
    pub fn reserve(&self, force: Force<N>) -> Energy<N> {
        force.modulus_fitting() * self.in_flight
    }

    /// The largest force that an energy, not below 0, can pay for over every displacement up to the furthest: `E/D`.
    ///
    /// It needs no root, because it leaves the damping as a reserve. It falls in proportion to the energy that is
    /// left, so the wall becomes softer as the account empties, and there is no sudden end.
    #[inline(always)]
    #[must_use]
    pub fn largest_force(&self, free: Energy<N>) -> Force<N> {
        (self.per_reach * free.digits_fitting()).down_fitting()
    }

    /// Makes up for a deficit: meanwhile no force is shown, so no energy is lost.
    #[cold]
    fn make_up(&self, state: &mut GuardState<N>, distance: Position<N>) -> Force<N> {
        *state = GuardState {
            account: (state.account + self.refill + self.damped(distance)).min(self.capacity),
            ..GuardState::default()
        };
        Force::zero()
    }

    /// Charges overspeed: the largest loss possible under the forces that acted and the one that acts until it is
    /// off.
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
