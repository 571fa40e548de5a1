//! State estimator: position, velocity and the hand's push, from counts, known inertia and damping, and commanded torque.
//!
//! A velocity taken as the difference of two counts is coarse and late, and a command acts later still. This estimator knows
//! what the device does by itself, `J dv/dt = -f - b v + J h`, with the force `f` that was commanded and the hand's push `h`
//! as an acceleration that stays as it is, so that only the hand is left to be found out. Per tick, with the velocity as a
//! displacement `d` per tick and the push as `g` per tick²:
//!
//! ```text
//! x⁻ = x + V d + X g - Σ q x_i f(n-1-i)     what the model expects     V, X, ρ: one tick of the damped device
//! d⁻ =     ρ d + V g - Σ q v_i f(n-1-i)     q = T²/J
//! r  = e - x⁻                               what was measured less that
//! x  = x⁻ + α r    d = d⁻ + β r    g = g + γ r
//! ```
//!
//! The three poles of its error are one and the same, `z = exp(-2π p T)` for a bandwidth `p`:
//! `α = 1 - z³/ρ`, `V γ = (1 - z)³`, `V β = 2 + ρ - 3z - α - X γ`. Then the state is taken ahead, by the same model and with the
//! commands that are on their way, over the time until the next command begins to act. That is what a law is given.
//!
//! **At rest it is exact**, to a step of the format at most: `g` sums up `r` until there is none, whatever inertia and torque
//! constant are assumed. So a wrong inertia costs accuracy while the device moves, and nothing when it is held.
//!
//! **Nothing overflows**, and nothing has to saturate on the way: a state that leaves `|r| < 8 rad`, `|d| < 4 rad` a tick or
//! `|g| < 4 rad` a tick², which no device does, starts anew at what was measured. So `|x| <= 128 + 8`; with commands that take less than
//! 2 rad in each tick (of what settings give, 1; examined where the coefficients are made) and at most two ticks ahead a sum stays below
//! `136 + 2·4 + 2·4 + 4 < 157` of 512 rad. See `proofs/src/estimator.rs`.

mod flow;
mod settings;

pub use crate::settings::EstimatorSettings;
pub(crate) use flow::approach;
pub use flow::{DeviceInTicks, Flow, TAPS, UNDER_WAY};
pub use settings::ratio_of_bits;
pub(crate) use settings::{check_bandwidth, per_tick};

use crate::law::Sample;
use crate::number::{Exact, Wide as _};
use crate::{Force, Number, Position};

/// The leading digits of a state in a format.
pub type Part<N> = <<N as Number>::Wide as crate::number::Wide>::Part;
/// A weight in a format.
pub type Weight<N> = <<N as Number>::Wide as crate::number::Wide>::Weight;

/// Coefficients of the estimator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimator<N: Number> {
    /// The motion from one sample to the next.
    pub tick: Flow<N, TAPS>,
    /// The motion from the sample to when the command that follows it begins to act.
    pub ahead: Flow<N, UNDER_WAY>,
    /// `α`, `β`, `γ`.
    pub correction: [Weight<N>; 3],
    /// Largest force that it takes a command for.
    pub limit: Force<N>,
}

/// Where the device is, how it moves, and how it is pushed: each with many digits.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EstimatedMotion<N: Number> {
    /// Penetration `x`, rad.
    pub position: N::Wide,
    /// Displacement per tick `d`, rad.
    pub moved: N::Wide,
    /// The hand's push `g`: the change of the displacement in each tick, rad.
    pub pushed: N::Wide,
}

/// Memory of [`Estimator`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EstimatorState<N: Number> {
    /// The motion at the last sample; `None` before the first one.
    pub motion: Option<EstimatedMotion<N>>,
    /// The last commands, the latest first.
    pub commands: [Part<N>; TAPS],
}

/// States that are larger than this power of two, rad a tick and rad a tick², belong to no device.
pub(crate) const LARGEST_MOTION_BITS: u32 = 2;
/// Measured and expected further apart than this power of two, rad: not the device that was there a tick before.
pub(crate) const LARGEST_SURPRISE_BITS: u32 = 3;

impl<N: Number> EstimatedMotion<N> {
    /// An estimate at rest at a measured position.
    #[must_use]
    pub fn standing(at: Position<N>) -> Self {
        Self {
            position: N::widen(at.0),
            ..Self::default()
        }
    }
}

/// The motion at a sample from the motion at the one before; `None` where no device could have moved like that.
#[inline(always)]
pub(crate) fn corrected<N: Number, const COMMANDS: usize>(
    tick: &Flow<N, COMMANDS>,
    correction: &[Weight<N>; 3],
    before: &EstimatedMotion<N>,
    commands: &[Part<N>; TAPS],
    measured: Position<N>,
) -> Option<EstimatedMotion<N>> {
    let (position, moved) = tick.apply(before, commands);
    let surprise = N::widen(measured.0).minus_fitting(position);
    if !surprise.within(LARGEST_SURPRISE_BITS) {
        return None;
    }
    let surprise = surprise.part();
    let [of_position, of_moved, of_pushed] = *correction;
    let after = EstimatedMotion::<N> {
        position: position.plus_fitting(N::Wide::product(of_position, surprise)),
        moved: moved.plus_fitting(N::Wide::product(of_moved, surprise)),
        pushed: before
            .pushed
            .plus_fitting(N::Wide::product(of_pushed, surprise)),
    };
    let possible =
        after.moved.within(LARGEST_MOTION_BITS) && after.pushed.within(LARGEST_MOTION_BITS);
    possible.then_some(after)
}

/// Whether a weight lies from 0 to `most`.
fn is_share<N: Number>(weight: Weight<N>, most: u8) -> bool {
    let most = N::Wide::weight(Exact::saturating_from_num(most));
    weight >= Weight::<N>::default() && most.is_some_and(|most| weight <= most)
}

impl<N: Number> Estimator<N> {
    /// Whether no sum of a tick can overflow: what `proofs/src/estimator.rs` assumes of its coefficients.
    #[must_use]
    pub fn is_bounded(&self) -> bool {
        let limit = N::widen(self.limit.0).torque_part();
        let [position, moved, pushed] = self.correction;
        self.tick.is_bounded(1, limit)
            && self.ahead.is_bounded(2, limit)
            && is_share::<N>(position, 1)
            && is_share::<N>(moved, 2)
            && is_share::<N>(pushed, 2)
            && self.limit >= Force::zero()
    }

    /// Runs one control period: takes the measured penetration, returns penetration and displacement per tick for the
    /// time at which the next command begins to act. [`Estimator::commanded`] must follow.
    #[inline(always)]
    pub fn tick(&self, state: &mut EstimatorState<N>, measured: Position<N>) -> Sample<N> {
        let motion = state
            .motion
            .and_then(|before| self.corrected(&before, &state.commands, measured))
            .unwrap_or(EstimatedMotion::standing(measured));
        state.motion = Some(motion);
        let (position, moved) = self.ahead.apply(&motion, &state.commands);
        Sample {
            e: Position(N::narrow(position)),
            moved: Position(N::narrow(moved)),
        }
    }

    /// The motion at a sample from the motion at the one before; `None` where no device could have moved like that.
    #[inline(always)]
    pub fn corrected(
        &self,
        before: &EstimatedMotion<N>,
        commands: &[Part<N>; TAPS],
        measured: Position<N>,
    ) -> Option<EstimatedMotion<N>> {
        corrected(&self.tick, &self.correction, before, commands, measured)
    }

    /// Tells the estimator the force that was commanded after a tick, pushing out of the wall: after every stage that
    /// may change it.
    #[inline(always)]
    pub fn commanded(&self, state: &mut EstimatorState<N>, force: Force<N>) {
        let [last, before, _] = state.commands;
        let force = N::widen(force.within(self.limit).0).torque_part();
        state.commands = [force, last, before];
    }
}
