//! An environment that takes the place of another while a hand is at it.
//!
//! **No jump.** The first tick shows what the last one showed. What that is more or less than the new environment asks for is carried along and
//! let go of at a stated rate: `f(n) = g(n) + d(n)` with `g` the new environment's own force and `|d(n+1)| <= |d(n)|`, `|d(n+1) - d(n)| <= r T`.
//! So a change adds at most `r T` a tick to what `g` does by itself.
//!
//! **No new account.** The guard goes on with its energy balance, and answers for what is carried as for any other force. A wall that appears under a
//! hand, deep inside of it, pushes it out with what the account has.

use super::{Environment, Reading, WallSettings};
use crate::{Controller, Energy, Force, Number, Si};

/// A force that belongs to no wall any more.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Carried<N: Number> {
    /// The last force before the change, until the first tick after it.
    before: Option<Force<N>>,
    /// The force that is added to the walls' own until it has faded.
    left: Force<N>,
    /// The force shrinks by this much in a tick.
    per_tick: Force<N>,
}

impl<N: Number> Environment<N> {
    /// The largest change of force in a tick at this rate in N·m/s (N/s); at least one step of the format.
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

    /// At the beginning of an arming: all memory is new, in place. The guard begins with an account where one is given, else goes on
    /// with its own.
    pub fn begin(&mut self, account: Option<Energy<N>>) {
        for wall in self.walls.iter_mut().flatten() {
            wall.forget();
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

    /// Replaces another environment with the same settings of law and guard while that one is at work. Walls that both
    /// have keep their memory.
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

    /// Same as [`Environment::take_over`], in the place of a single wall that is solid above its surface: needs that wall,
    /// the position of its last tick, and its force then.
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

    /// Adds the force that is carried along to the walls' own force.
    #[cold]
    #[inline(never)]
    pub(super) fn carried_onto(&mut self, own: Force<N>) -> Force<N> {
        let Some(carried) = &mut self.carried else {
            return own;
        };
        // The walls' force as it could be shown: what is beyond the limit is none that has to be let go of.
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

    /// Whether a change is still being carried out.
    #[must_use]
    pub fn is_changing(&self) -> bool {
        self.carried.is_some()
    }
}
