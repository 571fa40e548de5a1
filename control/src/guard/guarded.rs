//! The energy guard in use: its coefficients and memory, the last position, and whether it has shut the force off (tripped).

use super::{Guard, GuardState};
use crate::{Energy, Force, Number, Position, Si};

/// An energy guard with its memory. It shuts the force off (trips) after overspeed, or if the law requests a force at the end of
/// the range of positions. From then on it allows no force; [`Guarded::resumed`] lets a new guard continue with its energy
/// account.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Guarded<N: Number> {
    /// The guard's coefficients.
    pub guard: Guard<N>,
    /// The guard's memory: energy account and last forces.
    pub state: GuardState<N>,
    /// Position measured at the last tick; `None` before the first tick.
    pub last: Option<Position<N>>,
    /// Whether the guard allowed less force than the law requested at the last tick.
    pub limited: bool,
    /// Whether the guard has switched the force off. The cause is overspeed, or a requested force at the end of the range of
    /// positions.
    pub tripped: bool,
    /// Position, to either side, from which on no force is allowed: the end of the position format less two largest displacements
    /// per tick. A position beyond the format's end is measured as that end, so a motion there would not be counted.
    edge: Position<N>,
}

/// Angle in rad, to either side, from which on no force is commanded. Beyond the largest [`Si`] number, a measured angle would
/// stand still while the device moves on. This limit lies before that number by twice the largest displacement that any guard
/// accepts per tick (1,000 rad/s at one tick per second) and by 48 rad more for encoder counts.
pub const FURTHEST_ANGLE: Si = Si::lit("2147481600");

/// Displacement from the position `last` to the position `now`; 0 if `last` is `None`. Both are whole steps of the number format.
/// The result saturates.
#[inline(always)]
pub(crate) fn displacement<N: Number>(last: Option<Si>, now: Si) -> Position<N> {
    Position(N::saturating_signal(
        now.saturating_sub(last.unwrap_or(now)),
    ))
}

impl<N: Number> Guarded<N> {
    /// The guard at power-up, with a full energy account.
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

    /// Returns this guard with the account's energy of `before`, an earlier guard whose force has ended. So arming does not fill
    /// the account. The hand's motion between the two guards does not change the account.
    #[must_use]
    pub fn resumed(mut self, before: &Self) -> Self {
        self.resume(before.account());
        self
    }

    /// Same as [`Guarded::resumed`], given the energy in the earlier guard's account alone.
    #[inline]
    pub fn resume(&mut self, account: Energy<N>) {
        self.state = GuardState {
            account: account.min(self.guard.capacity),
            ..GuardState::default()
        };
    }

    /// Runs one control period. Takes the measured penetration, the penetration at which the force changed since the last tick
    /// (`None` if it is not measured), and the force that the law requests. Returns the force that is allowed.
    ///
    /// While a force acts, every counted displacement is the true one, although positions beyond the end of the position format
    /// are measured as that end. A force is allowed only at a position before `edge`, so the next position is at most one
    /// displacement beyond `edge`, unless that displacement counts as overspeed. A force still in effect ends with the sample
    /// after that one, at most at the format's end. Beyond `edge` no force acts, so a motion there costs no energy, and the
    /// measured displacement is at most the true one.
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

    /// Whether a position is too near the end of the position format for a force to be allowed.
    #[inline(always)]
    #[must_use]
    pub fn is_beyond_edge(&self, e: Position<N>) -> bool {
        e >= self.edge || e <= -self.edge
    }

    /// Same as [`Guarded::tick`], given the displacement since the last tick and how much of it passed before the force changed.
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

    /// Same as [`Guarded::tick`], for positions that may exceed the range of the number format. Takes the last position, this
    /// one, and the displacement since the force changed (`None` if it is not measured).
    ///
    /// Positions are whole steps of the number format, and a turn is a whole number of them. So displacements add up to the
    /// distance, are the same at every turn and never reach an end. The price is that a turn has a relative error of 10^-8 at 32
    /// bits. The axis is reversed if the force that acted was negative, so that a mirrored motion has mirrored roundings.
    #[inline(always)]
    pub fn tick_without_end(
        &mut self,
        last: Option<Si>,
        now: Si,
        since_change: Option<Position<N>>,
        wanted: Force<N>,
    ) -> Force<N> {
        let moved = displacement(last, now);
        let before_change = since_change.map_or(Position::zero(), |since| moved - since);
        self.tripped |= wanted != Force::zero() && now.saturating_abs() >= FURTHEST_ANGLE;
        let (force, older) = (self.state.force, self.state.older);
        let other_end = force < Force::zero() || (force == Force::zero() && older < Force::zero());
        self.moved_from(other_end, moved, before_change, wanted)
    }

    /// Same as [`Guarded::moved`] with the axis reversed. `moved`, `before_change` and the requested force `wanted` with opposite
    /// signs give the allowed force with the opposite sign. Roundings are mirrored too.
    #[inline]
    pub fn moved_mirrored(
        &mut self,
        moved: Position<N>,
        before_change: Position<N>,
        wanted: Force<N>,
    ) -> Force<N> {
        self.moved_from(true, moved, before_change, wanted)
    }

    /// Runs one control period, with the axis reversed if `other_end` is true. The code is long, so both directions share this
    /// function.
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

    /// Reports the force that was finally commanded, as [`Guard::commanded`] does.
    #[inline]
    pub fn commanded(&mut self, force: Force<N>) {
        self.guard.commanded(&mut self.state, force);
    }

    /// Reports that the force is switched off and that no tick follows, as [`Guard::switched_off`] does.
    pub fn switched_off(&mut self) {
        self.guard.switched_off(&mut self.state);
    }

    /// Energy in the guard's account: what the hand may still get out of the device.
    #[must_use]
    pub fn account(&self) -> Energy<N> {
        self.state.account
    }
}
