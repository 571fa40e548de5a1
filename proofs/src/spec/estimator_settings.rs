//! Specification of `EstimatorSettings::estimator`, which computes the estimator's coefficients. Read it beside the equations in
//! the header of `control/src/estimator/mod.rs`.
//!
//! Between settings and coefficients, numbers have 56 fractional bits and a range of ±128, and saturate.

use super::estimator::{Estimator, Flow};
use super::settings::{MOST, ONE, between, over, signal_fits, signal_of, times};
use super::{BITS, Int};

/// The value 1 with 56 fractional bits.
pub const LONG_ONE: Int = 1 << 56;
const LONG_MOST: Int = i64::MAX as Int;
/// `2π` with 56 fractional bits.
const TAU: Int = 452_751_216_129_820_177;

/// Limits a number to the range ±128 of numbers with 56 fractional bits.
fn long(x: Int) -> Int {
    x.clamp(-LONG_MOST - 1, LONG_MOST)
}
/// The product `a b` of numbers with 56 fractional bits. When the model checker runs, [`crate::reckoned`] replaces it.
#[must_use]
pub fn long_times(a: Int, b: Int) -> Int {
    long((a * b) >> 56)
}
/// The quotient `a / b` with 56 fractional bits, and 0 if it does not fit. When the model checker runs, [`crate::reckoned`]
/// replaces it.
#[must_use]
pub fn long_over(a: Int, b: Int) -> Int {
    let exact = if b == 0 { 0 } else { (a << 56) / b };
    if long(exact) == exact { exact } else { 0 }
}
/// The quotient `a / b` of two positive settings, with 56 fractional bits; the largest number for `b = 0`. When the model checker
/// runs, [`crate::reckoned`] replaces it.
#[must_use]
pub fn ratio(a: Int, b: Int) -> Int {
    if b == 0 {
        LONG_MOST
    } else {
        long((a << 56) / b)
    }
}

/// How far a device moves in a time `t` by a displacement per tick, `V = Σ (-β)^k t^(k+1)/(k+1)!`, and by a push of the hand (an
/// acceleration), `X = Σ (-β)^k t^(k+2)/(k+2)!`. `β` is the fraction of the velocity that damping takes per tick. When the model
/// checker runs, [`crate::reckoned`] replaces both.
#[must_use]
pub fn integrals(loss: Int, time: Int) -> (Int, Int) {
    let (mut reach, mut drift, mut term) = (0, 0, time);
    for order in 2..48 {
        let next = long_over(long_times(term, time), order * LONG_ONE);
        reach = long(reach + term);
        drift = long(drift + next);
        term = long(-long_times(next, loss));
    }
    (reach, drift)
}

/// Settings of the estimator as integers, in units of 2^-32 of their SI units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Bandwidth of the estimator, Hz.
    pub bandwidth: Int,
    /// Inertia of the device, kg·m².
    pub inertia: Int,
    /// Damping of the device, N·m·s/rad.
    pub damping: Int,
    /// Delay until a command acts, s.
    pub delay: Int,
}

/// `x` (56 fractional bits) rounded to `fraction` fractional bits; `None` if it does not fit a word.
fn weight(x: Int, fraction: u32) -> Option<Int> {
    let half = 1 << (55 - fraction);
    let nearest = (x + half).min(LONG_MOST) >> (56 - fraction);
    let most = 1 << (BITS - 1);
    (nearest >= -most && nearest < most).then_some(nearest)
}
fn of_motion(x: Int) -> Option<Int> {
    weight(x, 26)
}
fn of_torque(x: Int) -> Option<Int> {
    weight(x, 30)
}

/// Constants of the device: loss of velocity, acceleration per torque, and the delay, all with the tick as the unit of time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Device {
    /// Fraction of the velocity that damping takes per tick: damping times tick, divided by inertia.
    pub loss: Int,
    /// Acceleration in rad per tick² for each N·m of torque: squared tick divided by inertia.
    pub per_torque: Int,
    /// Time until a command begins to act, in ticks.
    pub delay: Int,
}

/// Weights of a prediction (state transition over a time), each with 56 fractional bits.
struct LongFlow<const COMMANDS: usize> {
    reach: Int,
    drift: Int,
    loss: Int,
    commands: [[Int; 2]; COMMANDS],
}

impl Device {
    /// Prediction of the motion over a time. The latest command ends `latest` ticks before the end; each earlier command ends one
    /// tick before the next.
    fn flow<const COMMANDS: usize>(&self, time: Int, latest: Int) -> LongFlow<COMMANDS> {
        let at = |t: Int| integrals(self.loss, t.max(0).min(time));
        let taken = |since, until| long_times(long(since - until), self.per_torque);
        let mut commands = [[0; 2]; COMMANDS];
        let mut until = at(latest);
        let mut i = 0;
        while i < COMMANDS {
            let since = at(latest + (i as Int + 1) * LONG_ONE);
            commands[i] = [taken(since.1, until.1), taken(since.0, until.0)];
            until = since;
            i += 1;
        }
        let (reach, drift) = integrals(self.loss, time);
        LongFlow {
            reach,
            drift,
            loss: long_times(reach, self.loss),
            commands,
        }
    }

    /// The gains by which the difference of measured and predicted position corrects position, displacement and the hand's push,
    /// for three equal poles at `z = exp(-angle)`. `None` if a gain does not fit a word. When the model checker runs,
    /// [`crate::reckoned`] replaces the gains.
    #[must_use]
    pub fn correction(&self, angle: Int) -> Option<[Int; 3]> {
        let fast = long_times(angle, integrals(angle, LONG_ONE).0);
        let pole = long(LONG_ONE - fast);
        let (reach, drift) = integrals(self.loss, LONG_ONE);
        let kept = long(LONG_ONE - long_times(self.loss, reach));
        let cube = |x| long_times(long_times(x, x), x);
        let position = long(LONG_ONE - long_over(cube(pole), kept));
        let pushed = long_over(cube(fast), reach);
        let sum = long(2 * LONG_ONE + kept);
        let sum = long(long(sum - long_times(pole, 3 * LONG_ONE)) - position);
        let moved = long(sum - long_times(drift, pushed));
        let moved = long_over(moved, reach);
        Some([of_motion(position)?, of_motion(moved)?, of_motion(pushed)?])
    }
}

/// A prediction (state transition) with its weights rounded to words; `None` if a weight does not fit.
fn weighed<const COMMANDS: usize>(long: &LongFlow<COMMANDS>) -> Option<Flow<COMMANDS>> {
    let mut commands = [[0; 2]; COMMANDS];
    let mut i = 0;
    while i < COMMANDS {
        let [of_position, of_velocity] = long.commands[i];
        commands[i] = [of_torque(of_position)?, of_torque(of_velocity)?];
        i += 1;
    }
    Some(Flow {
        reach: of_motion(long.reach)?,
        drift: of_motion(long.drift)?,
        loss: of_motion(long.loss)?,
        commands,
    })
}

/// Prediction of the motion over a tick; `None` if a weight does not fit a word. When the model checker runs, [`crate::reckoned`]
/// replaces it.
#[must_use]
pub fn over_a_tick(device: &Device) -> Option<Flow<3>> {
    weighed(&device.flow(LONG_ONE, -device.delay))
}
/// Prediction of the motion from a sample to the time when the next command begins to act; `None` if a weight does not fit a word.
/// When the model checker runs, [`crate::reckoned`] replaces it.
#[must_use]
pub fn ahead(device: &Device) -> Option<Flow<2>> {
    weighed(&device.flow(device.delay, 0))
}

/// The control rate in Hz; a rate of 0 is replaced by 1 Hz.
fn rate_of(rate: Int) -> Int {
    (rate.max(1) * ONE).min(MOST)
}

/// Whether `validate` accepts the settings. Besides the range of each setting, the bandwidth must be a 500th to a fifth of the
/// rate. The inertia divided by the squared tick, in N·m/rad, must be at least the largest force in N·m and at least 0.76, and at
/// most 6e7.
#[must_use]
pub fn in_ranges(set: &Settings, rate: Int, limit: Int) -> bool {
    let each = between(8_589_935, set.bandwidth, 20_000 * ONE)
        && between(0, set.inertia, 10_000 * ONE)
        && between(0, set.damping, 10_000 * ONE)
        && between(0, set.delay, 2 * ONE);
    if !each {
        return false;
    }
    let rate = rate_of(rate);
    let lightest = limit.max(3_264_175_145);
    between(over(rate, 500 * ONE), set.bandwidth, over(rate, 5 * ONE))
        && between(
            lightest,
            times(times(set.inertia, rate), rate),
            60_000_000 * ONE,
        )
}

/// The estimator of accepted settings, at a rate in Hz and for a largest force. `None` if a coefficient does not fit, or is beyond
/// what the properties of the estimator assume.
#[must_use]
pub fn made(set: &Settings, rate: Int, limit: Int) -> Option<Estimator> {
    let rate = rate_of(rate);
    // `J/T²`.
    let inertia = times(times(set.inertia, rate), rate);
    let angle = long_times(ratio(set.bandwidth, rate), TAU);
    let device = Device {
        loss: ratio(times(set.damping, rate), inertia).min(angle),
        per_torque: ratio(ONE, inertia),
        delay: ratio(times(set.delay, rate), ONE).min(2 * LONG_ONE),
    };
    let (tick, ahead) = (over_a_tick(&device), ahead(&device));
    let made = Estimator {
        tick: tick?,
        ahead: ahead?,
        correction: device.correction(angle)?,
        limit: signal_of(limit),
    };
    (signal_fits(limit) && bounded(&made)).then_some(made)
}

/// Whether a prediction over `ticks` ticks is bounded. Commands up to the limit change position and displacement by less than 2 rad
/// per tick (with 54 fractional bits). The weights of displacement and push are at most the time in ticks, damping takes at most
/// the whole velocity, and no weight is negative.
#[must_use]
pub fn flow_bounded<const COMMANDS: usize>(flow: &Flow<COMMANDS>, ticks: Int, limit: Int) -> bool {
    let taken = |which: usize| {
        let by_one = |of: &[Int; 2]| super::estimator::weighed(of[which], limit);
        flow.commands.iter().map(by_one).sum::<Int>()
    };
    let one = 1 << 26;
    flow.commands.iter().flatten().all(|weight| *weight >= 0)
        && taken(0) < ticks << 55
        && taken(1) < ticks << 55
        && between(0, flow.reach, ticks * one)
        && between(0, flow.drift, ticks * one)
        && between(0, flow.loss, one)
}

/// The conditions on an estimator that `proofs/src/estimator.rs` assumes.
#[must_use]
pub fn bounded(of: &Estimator) -> bool {
    let one = 1 << 26;
    let [position, moved, pushed] = of.correction;
    of.limit >= 0
        && flow_bounded(&of.tick, 1, of.limit)
        && flow_bounded(&of.ahead, 2, of.limit)
        && between(0, position, one)
        && between(0, moved, 2 * one)
        && between(0, pushed, 2 * one)
}
