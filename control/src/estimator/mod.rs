//! State estimator: position, velocity and the hand's push, from encoder counts, known inertia and damping, and commanded torque.
//!
//! A velocity taken as the difference of two counts is coarse and late, and a command acts later still. This estimator models the
//! device's own motion, `J dv/dt = -f - b v + J h`, with inertia `J`, velocity `v`, damping `b` and the commanded force `f`. The
//! hand's push `h` is an acceleration that is assumed constant. So only the hand's push has to be estimated. Per tick, with the
//! position `x`, the velocity as a displacement `d` per tick, the push as `g` per tick², the measured position `e` and the gains
//! `α`, `β`, `γ`:
//!
//! ```text
//! x⁻ = x + V d + X g - Σ q x_i f(n-1-i)     position that the model expects
//! d⁻ =     ρ d + V g - Σ q v_i f(n-1-i)     q = T²/J;  x_i, v_i: weights of the command f(n-1-i)
//! r  = e - x⁻                               measured less expected position
//! x  = x⁻ + α r    d = d⁻ + β r    g = g + γ r
//! ```
//!
//! Here `V`, `X` and `ρ = 1 - b T V/J` are the coefficients of [`Flow`] over one tick `T`. The three poles of the estimator's
//! error are equal, `z = exp(-2π p T)` for a bandwidth `p`: `α = 1 - z³/ρ`, `V γ = (1 - z)³`, `V β = 2 + ρ - 3z - α - X γ`. Then
//! the same model predicts the state for the time at which the next command begins to act, with the commands that are already
//! given but not yet in effect. The law gets that prediction.
//!
//! **At rest the position is exact** to within a step of the number format: `g` sums up `r` until `r` is zero, for any assumed
//! inertia and torque constant. So a wrong inertia costs accuracy while the device moves, and none while the device is held.
//!
//! **Nothing overflows**, and no sum has to saturate. A state that leaves `|r| < 8 rad`, `|d| < 4 rad` per tick or `|g| < 4 rad`
//! per tick², which no real device does, is reset to the measured position. So `|x| <= 128 + 8`. Commands take less than 2 rad in
//! each tick (settings allow 1; the coefficients are checked) over at most two ticks. So a sum stays below `136 + 2·4 + 2·4 + 4 <
//! 157` of 512 rad. See `proofs/src/estimator.rs`.

mod flow;
mod settings;

pub use crate::settings::EstimatorSettings;
pub(crate) use flow::approach;
pub use flow::{DeviceInTicks, Flow, TAPS, UNDER_WAY};
pub use settings::ratio_of_bits;
pub(crate) use settings::{check_bandwidth, per_tick};

use crate::number::{Exact, Wide as _};
use crate::sample::Sample;
use crate::{Force, Number, Position};

/// The leading digits of an estimator's state (position, velocity, or the hand's push as an acceleration): a short number that can
/// be multiplied fast.
pub type Part<N> = <<N as Number>::Wide as crate::number::Wide>::Part;
/// The type of the coefficients with which the leading digits of an estimator's state are multiplied.
pub type Weight<N> = <<N as Number>::Wide as crate::number::Wide>::Weight;

/// Coefficients of the state estimator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimator<N: Number> {
    /// The modelled motion over one tick, from one sample to the next.
    pub tick: Flow<N, TAPS>,
    /// The modelled motion from a sample to the time at which the command that follows it begins to act.
    pub ahead: Flow<N, UNDER_WAY>,
    /// Gains `α`, `β`, `γ` of the difference between measured and predicted position. They correct the estimates of position,
    /// displacement per tick, and the hand's push (as an acceleration).
    pub correction: [Weight<N>; 3],
    /// Largest force that the estimator accepts as a command; a larger force is limited to this value.
    pub limit: Force<N>,
}

/// Estimated position, velocity and acceleration by the hand's push, each with more digits than a position has elsewhere.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EstimatedMotion<N: Number> {
    /// Estimated penetration, rad.
    pub position: N::Wide,
    /// Estimated displacement per tick, rad.
    pub moved: N::Wide,
    /// The hand's push as an acceleration: change of the displacement per tick in each tick, rad.
    pub pushed: N::Wide,
}

/// Memory of the state [`Estimator`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EstimatorState<N: Number> {
    /// The estimated motion at the last sample; `None` before the first one.
    pub motion: Option<EstimatedMotion<N>>,
    /// The last commanded forces, the latest first.
    pub commands: [Part<N>; TAPS],
}

/// Bits of the largest plausible motion: 2^2 rad per tick or rad per tick². An estimate above this limit is reset to the measured
/// position, because no device moves so fast.
pub(crate) const LARGEST_MOTION_BITS: u32 = 2;
/// Bits of the largest plausible error of a prediction, 2^3 rad. If measured and expected position differ by more, the estimate is
/// reset to the measured position.
pub(crate) const LARGEST_SURPRISE_BITS: u32 = 3;

impl<N: Number> EstimatedMotion<N> {
    /// An estimate of a device at rest at a measured position.
    #[must_use]
    pub fn standing(at: Position<N>) -> Self {
        Self {
            position: N::widen(at.0),
            ..Self::default()
        }
    }
}

/// Calculates the estimate at this sample: the motion that the model expects from the estimate at the sample before, corrected by
/// the measured position. `None` if the motion is implausible by `LARGEST_SURPRISE_BITS` or `LARGEST_MOTION_BITS`.
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

/// Whether a coefficient is from 0 to `most`.
fn is_share<N: Number>(weight: Weight<N>, most: u8) -> bool {
    let most = N::Wide::weight(Exact::saturating_from_num(most));
    weight >= Weight::<N>::default() && most.is_some_and(|most| weight <= most)
}

impl<N: Number> Estimator<N> {
    /// Whether no sum of the estimator in a tick can overflow with these coefficients. The proof in `proofs/src/estimator.rs`
    /// assumes that this function returns true.
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

    /// Runs one control period: takes the measured penetration, returns penetration and displacement per tick, predicted for the
    /// time at which the next command begins to act. The caller must call [`Estimator::commanded`] next.
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

    /// The estimated motion at this sample, from the estimate at the sample before and the measured position. `None` if the
    /// motion is implausible: 8 rad or more between measured and expected position, or a displacement or push of 4 rad or more
    /// per tick or tick².
    #[inline(always)]
    pub fn corrected(
        &self,
        before: &EstimatedMotion<N>,
        commands: &[Part<N>; TAPS],
        measured: Position<N>,
    ) -> Option<EstimatedMotion<N>> {
        corrected(&self.tick, &self.correction, before, commands, measured)
    }

    /// Reports to the estimator the force that was commanded after a tick (positive out of the wall), as changed by all later
    /// stages.
    #[inline(always)]
    pub fn commanded(&self, state: &mut EstimatorState<N>, force: Force<N>) {
        let [last, before, _] = state.commands;
        let force = N::widen(force.within(self.limit).0).torque_part();
        state.commands = [force, last, before];
    }
}
