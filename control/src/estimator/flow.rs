//! The motion of the modelled device over a time span. It is a weighted sum of the position, velocity and the hand's push (an
//! acceleration) at the start, and of the commanded torques.

use super::{EstimatedMotion, Part, Weight, is_share};
use crate::Number;
use crate::number::{Exact, Wide};

/// Number of past commands that the estimator remembers. With a delay of more than one tick (the longest is two), the third-last
/// command still acts during the last tick.
pub const TAPS: usize = 3;
/// Largest number of commanded forces that are not yet in effect when a position is sampled.
pub const UNDER_WAY: usize = 2;
/// Longest delay over which the estimator predicts, ticks.
pub(super) const LONGEST_DELAY: u8 = UNDER_WAY as u8;

/// The exact motion of an inertia `J` with damping `b` over a time `t` in ticks, under torques that are each held for a tick. `T`
/// is the tick in seconds.
///
/// With `β = b T/J`: `V(t) = ∫ exp(-β s) ds`, `X(t) = ∫ V(s) ds`, from 0 to `t`. A displacement `d` per tick moves the device by
/// `V d` and becomes `(1 - β V) d`. An acceleration of 1 per tick² moves the device by `X` and adds `V` to the displacement per
/// tick. A command of 1 N·m, out of the wall, that acts from `s` to `r` ticks before the end moves the device outward by `q
/// (X(s) - X(r))`, with `q = T²/J`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flow<N: Number, const COMMANDS: usize> {
    /// Displacement over the time span for each unit of displacement per tick at its start.
    pub reach: Weight<N>,
    /// Displacement over the time span for each unit of acceleration per tick².
    pub drift: Weight<N>,
    /// Fraction of the initial displacement per tick that damping takes over the time span.
    pub loss: Weight<N>,
    /// For each command, the latest first: how much a command of 1 N·m takes from the position and from the displacement per tick.
    pub commands: [[Weight<N>; 2]; COMMANDS],
}

/// A device's inertia, damping and delay with the tick as the unit of time, from which the motion over a time span is computed.
#[derive(Debug, Clone, Copy)]
pub struct DeviceInTicks {
    /// Fraction of the velocity that damping takes per tick, to first order: damping times tick over inertia, `b T/J`.
    pub loss: Exact,
    /// Acceleration per tick² by a torque of 1 N·m: tick squared over inertia, `T²/J`, rad/(N·m).
    pub per_torque: Exact,
    /// Time until a command begins to act, ticks.
    pub delay: Exact,
}

/// Number of terms of the power series in `β t`, the loss of velocity per tick times the number of ticks. For `β t` up to 4, more
/// terms change no digit.
const TERMS: i64 = 48;

impl DeviceInTicks {
    /// The displacements by a unit velocity (`V`, ticks) and by a unit acceleration (`X`, ticks²) over a time in ticks. For damping
    /// times time over inertia from 0 to 4; the series is inaccurate above.
    #[inline]
    pub fn integrals(&self, time: Exact) -> (Exact, Exact) {
        let (mut reach, mut drift) = (Exact::ZERO, Exact::ZERO);
        let mut term = time;
        for k in 2..TERMS {
            // All terms after a term of 0 are 0, which with little damping happens after a few terms.
            if term == Exact::ZERO {
                break;
            }
            let next = term
                .saturating_mul(time)
                .checked_div_int(k)
                .unwrap_or_default();
            reach = reach.saturating_add(term);
            drift = drift.saturating_add(next);
            term = next.saturating_mul(self.loss).saturating_neg();
        }
        (reach, drift)
    }

    /// The motion over one tick, from one sample to the next; `None` if a weight does not fit its format.
    pub fn tick<N: Number>(&self) -> Option<Flow<N, TAPS>> {
        // The command given i + 1 ticks before the sample began to act 1 + i - delay ticks before the sample.
        self.flow(Exact::ONE, |i| i.saturating_sub(self.delay))
    }

    /// The motion from a sample to the time at which the command that follows it begins to act; `None` if a weight does not fit
    /// its format.
    pub fn ahead<N: Number>(&self) -> Option<Flow<N, UNDER_WAY>> {
        self.flow(self.delay, |i| i)
    }

    /// The modelled motion over a time in ticks. Each command acts for one tick and ends a given number of ticks before the end of
    /// that time.
    fn flow<N: Number, const COMMANDS: usize>(
        &self,
        time: Exact,
        end: impl Fn(Exact) -> Exact,
    ) -> Option<Flow<N, COMMANDS>> {
        // `clamp` is not used, because it panics for a negative time.
        let inside = |t: Exact| t.max(Exact::ZERO).min(time);
        let taken = |before: Exact, after: Exact| {
            before.saturating_sub(after).saturating_mul(self.per_torque)
        };
        let mut torques = [[Exact::ZERO; 2]; COMMANDS];
        let mut index = Exact::ZERO;
        let mut after = self.integrals(inside(end(index)));
        for torque in &mut torques {
            index = index.saturating_add(Exact::ONE);
            // Each command ends where the next later one begins.
            let before = self.integrals(inside(end(index)));
            *torque = [taken(before.1, after.1), taken(before.0, after.0)];
            after = before;
        }
        let (reach, drift) = self.integrals(time);
        let loss = reach.saturating_mul(self.loss);

        let weight = <N::Wide as Wide>::weight;
        let mut commands = [[Weight::<N>::default(); 2]; COMMANDS];
        for (command, torque) in commands.iter_mut().zip(torques) {
            *command = [
                <N::Wide as Wide>::torque_weight(torque[0])?,
                <N::Wide as Wide>::torque_weight(torque[1])?,
            ];
        }
        Some(Flow {
            reach: weight(reach)?,
            drift: weight(drift)?,
            loss: weight(loss)?,
            commands,
        })
    }
}

impl<N: Number> Flow<N, 0> {
    /// The motion over one tick of a device without damping and without commands. A velocity of 1 per tick moves the device by 1,
    /// an acceleration of 1 per tick² by 1/2. `None` if a weight does not fit its format.
    #[must_use]
    pub fn free() -> Option<Self> {
        let weight = <N::Wide as Wide>::weight;
        Some(Self {
            reach: weight(Exact::ONE)?,
            drift: weight(const { Exact::lit("0.5") })?,
            loss: weight(Exact::ZERO)?,
            commands: [],
        })
    }
}

/// Fraction of a step that a first-order filter has covered after `angle` time constants: `1 - exp(-angle)`, for `angle` from 0 to
/// 4.
#[inline]
pub(crate) fn approach(angle: Exact) -> Exact {
    // exp(-a) = 1 - a φ(a), and `integrals` gives V = t φ(β t) for a time t and a loss β. With a as the loss and 1 as the time, V
    // is φ(a).
    let decay = DeviceInTicks {
        loss: angle,
        per_torque: Exact::ZERO,
        delay: Exact::ZERO,
    };
    angle.saturating_mul(decay.integrals(Exact::ONE).0)
}

impl<N: Number, const COMMANDS: usize> Flow<N, COMMANDS> {
    /// Whether the sums of [`Flow::apply`] cannot overflow over `ticks` ticks (1 or 2). The conditions are: no weight is
    /// negative; `reach` and `drift` are at most the time in ticks, `loss` at most 1. Commands up to the force limit change the
    /// position, and the displacement per tick, by less than 2 rad in one tick and 4 rad in two.
    pub(super) fn is_bounded(&self, ticks: u8, limit: Part<N>) -> bool {
        let mut taken = [N::Wide::default(); 2];
        let mut fits = true;
        for command in &self.commands {
            for (weight, taken) in command.iter().zip(&mut taken) {
                let by_one = N::Wide::product(*weight, limit);
                fits &= *weight >= Weight::<N>::default() && by_one.within(ticks.into());
                if fits {
                    *taken = taken.plus_fitting(by_one);
                }
                fits &= taken.within(ticks.into());
            }
        }
        fits && is_share::<N>(self.reach, ticks)
            && is_share::<N>(self.drift, ticks)
            && is_share::<N>(self.loss, 1)
    }

    /// Calculates position and displacement per tick at the end of the time span.
    #[inline(always)]
    pub fn apply(
        &self,
        from: &EstimatedMotion<N>,
        commands: &[Part<N>; TAPS],
    ) -> (N::Wide, N::Wide) {
        let (moved, pushed) = (from.moved.part(), from.pushed.part());
        let mut position = from
            .position
            .plus_fitting(N::Wide::product(self.reach, moved))
            .plus_fitting(N::Wide::product(self.drift, pushed));
        let mut velocity = from
            .moved
            .minus_fitting(N::Wide::product(self.loss, moved))
            .plus_fitting(N::Wide::product(self.reach, pushed));
        for ([of_position, of_velocity], command) in self.commands.iter().zip(commands) {
            position = position.minus_fitting(N::Wide::product(*of_position, *command));
            velocity = velocity.minus_fitting(N::Wide::product(*of_velocity, *command));
        }
        (position, velocity)
    }
}
