//! A guard at work: its coefficients beside its memory, the last position, and the trip.

use super::{Guard, GuardState};
use crate::{Energy, Force, Number, Position};

/// A guard with its memory. After overspeed it shows no force any more, until it is taken up again ([`Guarded::resumed`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guarded<N: Number> {
    /// Coefficients.
    pub guard: Guard<N>,
    /// Memory.
    pub state: GuardState<N>,
    /// Measured position of the last tick; `None` before the first one.
    pub last: Option<Position<N>>,
    /// Whether the law got less than it wanted at the last tick.
    pub limited: bool,
    /// Whether there was overspeed.
    pub tripped: bool,
}

impl<N: Number> Guarded<N> {
    /// At power-up: a full account.
    #[must_use]
    pub fn new(guard: Guard<N>) -> Self {
        Self {
            guard,
            state: guard.full(),
            last: None,
            limited: false,
            tripped: false,
        }
    }

    /// With the account of another, whose force has ended: arming is no reason for a full one. What the hand did meanwhile
    /// cost nothing, and is not counted for it either.
    #[must_use]
    pub fn resumed(mut self, before: &Self) -> Self {
        self.resume(before.account());
        self
    }

    /// The same for an account alone.
    #[inline]
    pub fn resume(&mut self, account: Energy<N>) {
        self.state = GuardState {
            account: account.min(self.guard.capacity),
            ..GuardState::default()
        };
    }

    /// One control period: the measured penetration, that at which the force changed since the last tick (where it is
    /// measured), and the force that the law wants, to the force that it may have.
    #[inline]
    pub fn tick(
        &mut self,
        e: Position<N>,
        at_change: Option<Position<N>>,
        wanted: Force<N>,
    ) -> Force<N> {
        let last = self.last.replace(e).unwrap_or(e);
        let before_change = at_change.map_or(Position::zero(), |x| x - last);
        self.moved(e - last, before_change, wanted)
    }

    /// The same for a displacement since the last tick, and the part of it before the force changed.
    #[inline(always)]
    pub fn moved(
        &mut self,
        moved: Position<N>,
        before_change: Position<N>,
        wanted: Force<N>,
    ) -> Force<N> {
        let guarded = self
            .guard
            .tick_with_change(&mut self.state, moved, before_change, wanted);
        self.tripped |= guarded.is_err();
        let force = match guarded {
            Ok(force) if !self.tripped => force,
            _ => {
                self.guard.commanded(&mut self.state, Force::zero());
                Force::zero()
            }
        };
        self.limited = force != wanted;
        force
    }

    /// The same tick seen from the other end of the axis: `moved`, `before_change` and `wanted` with their signs changed give the
    /// force with its own changed, and each rounding falls on the mirrored side of the books.
    #[inline]
    pub fn moved_mirrored(
        &mut self,
        moved: Position<N>,
        before_change: Position<N>,
        wanted: Force<N>,
    ) -> Force<N> {
        self.mirror();
        let force = -self.moved(-moved, -before_change, -wanted);
        self.mirror();
        force
    }

    fn mirror(&mut self) {
        let GuardState { force, older, .. } = &mut self.state;
        (*force, *older) = (-*force, -*older);
    }

    /// What the hand may still get out.
    #[must_use]
    pub fn account(&self) -> Energy<N> {
        self.state.account
    }
}
