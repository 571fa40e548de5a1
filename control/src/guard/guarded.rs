//! A guard at work: its coefficients beside its memory, the last position, and the trip.

use super::{Guard, GuardState};
use crate::{Energy, Force, Number, Position, Si};

/// A guard with its memory. After overspeed, and where a force is wanted at the end of what positions can say, it shows no force any
/// more, until it is taken up again ([`Guarded::resumed`]).
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
    /// Whether there was overspeed, or a force was wanted beyond the edge.
    pub tripped: bool,
    /// From here on, to either side, no force is shown: two furthest displacements before the format's end. A position beyond that end
    /// is measured as that end, so that a motion there would not be counted.
    edge: Position<N>,
}

impl<N: Number> Guarded<N> {
    /// The state at power-up: a full account.
    #[must_use]
    pub fn new(guard: Guard<N>) -> Self {
        let end = Position(N::saturating_signal(Si::MAX));
        Self {
            guard,
            state: guard.full(),
            last: None,
            limited: false,
            tripped: false,
            edge: end - guard.furthest - guard.furthest,
        }
    }

    /// This guard with the account of an earlier one whose force has ended: arming does not fill the account. What the
    /// hand did in between neither costs nor earns anything.
    #[must_use]
    pub fn resumed(mut self, before: &Self) -> Self {
        self.resume(before.account());
        self
    }

    /// Same as [`Guarded::resumed`], given the account alone.
    #[inline]
    pub fn resume(&mut self, account: Energy<N>) {
        self.state = GuardState {
            account: account.min(self.guard.capacity),
            ..GuardState::default()
        };
    }

    /// Runs one control period: takes the measured penetration, the one at which the force changed since the last tick
    /// (where it is measured), and the force that the law wants. Returns the force that is allowed.
    ///
    /// While a force acts, every counted displacement is the true one. The sample before was before the edge of the
    /// format, so the next one is at most one displacement beyond it, unless that is overspeed. A force still on its
    /// way ends with the sample after that, at most at the format's end. Beyond the edge no force acts, so a motion
    /// costs nothing, and what is measured of it is not more than it was.
    #[inline]
    pub fn tick(
        &mut self,
        e: Position<N>,
        at_change: Option<Position<N>>,
        wanted: Force<N>,
    ) -> Force<N> {
        let last = self.last.replace(e).unwrap_or(e);
        let before_change = at_change.map_or(Position::zero(), |x| x - last);
        self.tripped |= wanted != Force::zero() && self.is_beyond_edge(e);
        self.moved(e - last, before_change, wanted)
    }

    /// Whether a position is too near the format's end for a force.
    #[inline(always)]
    #[must_use]
    pub fn is_beyond_edge(&self, e: Position<N>) -> bool {
        e >= self.edge || e <= -self.edge
    }

    /// Same as [`Guarded::tick`], given the displacement since the last tick and the part of it before the force changed.
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
                self.commanded(Force::zero());
                Force::zero()
            }
        };
        self.limited = force != wanted;
        force
    }

    /// Same as [`Guarded::moved`], seen from the other end of the axis. `moved`, `before_change` and `wanted` with changed
    /// signs give the force with a changed sign; each rounding falls on the mirrored side of the account.
    #[inline]
    pub fn moved_mirrored(
        &mut self,
        moved: Position<N>,
        before_change: Position<N>,
        wanted: Force<N>,
    ) -> Force<N> {
        self.moved_from(true, moved, before_change, wanted)
    }

    /// The tick for both ends of the axis. It is long, so a program has it only once.
    #[inline]
    pub(crate) fn moved_from(
        &mut self,
        other_end: bool,
        moved: Position<N>,
        before_change: Position<N>,
        wanted: Force<N>,
    ) -> Force<N> {
        let seen = |way: Position<N>| if other_end { -way } else { way };
        let turned = |force: Force<N>| if other_end { -force } else { force };
        if other_end {
            self.mirror();
        }
        let force = self.moved(seen(moved), seen(before_change), turned(wanted));
        if other_end {
            self.mirror();
        }
        turned(force)
    }

    fn mirror(&mut self) {
        let GuardState { force, older, .. } = &mut self.state;
        (*force, *older) = (-*force, -*older);
    }

    /// The force that was commanded in the end: [`Guard::commanded`].
    #[inline]
    pub fn commanded(&mut self, force: Force<N>) {
        self.guard.commanded(&mut self.state, force);
    }

    /// The force is switched off, and no tick follows: [`Guard::switched_off`].
    pub fn switched_off(&mut self) {
        self.guard.switched_off(&mut self.state);
    }

    /// Energy that the hand may still get out.
    #[must_use]
    pub fn account(&self) -> Energy<N> {
        self.state.account
    }
}
