//! Replaces an environment (walls, detents, torque profile) by another while a hand touches it.
//!
//! **No jump of the force.** The first tick of the new environment commands the last force of the old one. The new environment
//! has the force `g`. The difference `d` between the old force and `g` is added to `g`, and fades at a configured rate `r` in
//! N·m/s (N/s). The commanded force is `f(n) = g(n) + d(n)` with `|d(n+1)| <= |d(n)|` and `|d(n+1) - d(n)| <= r T`. So a change
//! of environment adds at most `r T` per tick of length `T` to the changes of `g`.
//!
//! **No new energy.** The guard keeps its energy account and counts the fading force like any other. If a wall appears around a
//! hand that is deep inside it, the wall pushes the hand out with at most the energy in the account.

use super::{Environment, Reading, WallSettings};
use crate::{Controller, Energy, Force, Number, Si};

/// The difference between the last force of a replaced environment (walls and detents) and the force of the new one, while it
/// fades.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Carried<N: Number> {
    /// The last force before the change of environment, kept until the first tick after the change.
    before: Option<Force<N>>,
    /// The force that is added to the new environment's own force until it has faded to zero.
    left: Force<N>,
    /// The added force shrinks by this much per tick.
    per_tick: Force<N>,
}

impl<N: Number> Environment<N> {
    /// Converts a rate of change of force, N·m/s (N/s), to a change per tick at a control rate in Hz. At least one step of the
    /// number format.
    #[must_use]
    pub fn change_per_tick(rate: Si, rate_hz: u32) -> Force<N> {
        let ticks = Si::saturating_from_num(rate_hz.max(1));
        let per_tick = Force(N::saturating_signal(rate.saturating_div(ticks)));
        if per_tick < Force(N::QUANTUM) {
            Force(N::QUANTUM)
        } else {
            per_tick
        }
    }

    /// Clears all memory in place when the force is switched on (arming). The guard's energy account starts at the given energy,
    /// or keeps its energy if none is given.
    pub fn begin(&mut self, account: Option<Energy<N>>) {
        for wall in self.walls.iter_mut().flatten() {
            wall.forget();
        }
        if let Some(feel) = &mut self.feel {
            feel.forget();
        }
        if let Some(guard) = &mut self.guard {
            guard.resume(account.unwrap_or(guard.account()));
            (guard.last, guard.limited, guard.tripped) = (None, false, false);
        }
        self.last = None;
        self.commanded = Force::zero();
        self.shown = Force::zero();
        self.carried = None;
    }

    /// Makes this environment replace the running environment `before`. Both must be made with the same settings of law and
    /// guard. Walls that are in both environments keep their memory. The difference between the last force of `before` and the
    /// force of this environment shrinks by `per_tick` in each tick.
    pub fn take_over(&mut self, before: &Self, per_tick: Force<N>) {
        for place in self.walls.iter_mut().flatten() {
            let same = before
                .walls
                .iter()
                .flatten()
                .find(|it| it.wall == place.wall);
            if let Some(same) = same {
                *place = *same;
            }
        }
        self.guard = before.guard;
        self.last = before.last;
        self.commanded = before.commanded;
        self.carry(before.shown, per_tick);
    }

    /// Same as [`Environment::take_over`], if a controller of a single wall ran before. Takes the settings of that wall, which is
    /// solid above its surface, and the position and force of the controller's last tick.
    pub fn take_over_from(
        &mut self,
        before: &Controller<N>,
        wall: &WallSettings,
        (at, shown): (&impl Reading<N>, Force<N>),
        per_tick: Force<N>,
    ) {
        let mut places = self.walls.iter_mut().flatten();
        if let Some(place) = places.find(|place| place.wall == *wall) {
            (place.states, place.law) = (before.states, before.law);
            (place.surface, place.impact) = (before.surface, before.impact);
        }
        self.guard = before.guard;
        self.last = Some(at.on_steps(self.step));
        self.commanded = before.last_commanded();
        self.carry(shown, per_tick);
    }

    fn carry(&mut self, shown: Force<N>, per_tick: Force<N>) {
        self.shown = shown;
        self.carried = Some(Carried {
            before: Some(shown),
            left: Force::zero(),
            per_tick,
        });
    }

    /// Adds the fading difference to `own`, the force of this environment. The difference is the replaced environment's last
    /// force less this environment's first.
    #[cold]
    #[inline(never)]
    pub(super) fn carried_onto(&mut self, own: Force<N>) -> Force<N> {
        let Some(carried) = &mut self.carried else {
            return own;
        };
        // The new walls' force within the force limit: a force beyond the limit is never commanded, so no difference to it has to
        // fade.
        let own = own.within(self.limit);
        carried.left = match carried.before.take() {
            Some(before) => before - own,
            None => carried.left - carried.left.within(carried.per_tick),
        };
        let left = carried.left;
        if left == Force::zero() {
            self.carried = None;
        }
        own + left
    }

    /// Whether the difference to the force of a replaced environment is still fading.
    #[must_use]
    pub fn is_changing(&self) -> bool {
        self.carried.is_some()
    }
}
