//! Properties of the state estimator: no sum overflows, no state leaves its range, and at rest nothing moves.
//!
//! All properties are at 32 bits. They hold for every estimator whose weights (coefficients) are within what settings allow
//! ([`ok`]), not only for those of one device. A correction is proved for any gain up to its bound.

use crate::source::Source;
use crate::{bounded_property, cover, limited_property, property, reckoned, such};
use touchstone_control::estimator::{EstimatedMotion, Flow, TAPS, UNDER_WAY};
use touchstone_control::law::Sample;
use touchstone_control::number::{Wide as _, Wide64};
use touchstone_control::{Estimator, Fixed32, Force, Number, Position};

type N = Fixed32;

/// The value 1 as a weight (coefficient) of motion, with 26 fractional bits.
const ONE: i32 = 1 << 26;
const ONE_TORQUE: i64 = 1 << 30;
const RAD: i64 = 1 << Wide64::FRACTION;

/// A weight (coefficient) with any bits under the model checker. In random tests it is mostly from 0 to `most`, because settings
/// give few of the other weights.
fn weight<S: Source>(s: &mut S, most: i64) -> i32 {
    let x = s.i32();
    if s.shortcut() {
        i64::from(x).rem_euclid(most.min(i64::from(i32::MAX)) + 1) as i32
    } else {
        x
    }
}

fn any_flow<S: Source, const COMMANDS: usize>(
    s: &mut S,
    ticks: i64,
    limit: Force<N>,
) -> Flow<N, COMMANDS> {
    let one = i64::from(ONE);
    let limit = i64::from(limit.0.to_bits()).max(1);
    // For random tests only: the checker need not follow a division.
    let share = if s.shortcut() {
        (2 * ONE_TORQUE).min(RAD / limit) * ticks / COMMANDS as i64
    } else {
        i64::from(i32::MAX)
    };
    Flow {
        reach: weight(s, ticks * one),
        drift: weight(s, ticks * one),
        loss: weight(s, one),
        commands: core::array::from_fn(|_| [weight(s, share), weight(s, share)]),
    }
}

/// Product of a weight (coefficient) and the force limit. When the model checker runs, [`crate::reckoned`] replaces it here and in
/// the code.
fn times(weight: i32, limit: i64) -> i64 {
    i64::from(weight) * limit
}

/// Whether a prediction over up to `ticks` ticks is bounded: its weights of the displacement and of the hand's push are at most the
/// time in ticks, and damping takes at most the whole motion. All commands together, each at the limit, change position and
/// displacement by less than 2 rad per tick.
fn flow_ok<const COMMANDS: usize>(flow: &Flow<N, COMMANDS>, ticks: i32, limit: i64) -> bool {
    let within = |x: i32, most: i32| x >= 0 && x <= most;
    let most = 2 * RAD * i64::from(ticks);
    let taken = |index: usize| {
        let each = || flow.commands.iter().map(|c| times(c[index], limit));
        flow.commands.iter().all(|c| c[index] >= 0)
            && each().all(|taken| taken < most)
            && each().sum::<i64>() < most
    };
    within(flow.reach, ticks * ONE)
        && within(flow.drift, ticks * ONE)
        && within(flow.loss, ONE)
        && taken(0)
        && taken(1)
}

/// An estimator with any weights (coefficients); in random tests mostly weights that settings can give.
pub fn any<S: Source>(s: &mut S) -> Estimator<N> {
    let one = i64::from(ONE);
    let limit = Force(fixed::types::I8F24::from_bits(weight(
        s,
        i64::from(i32::MAX),
    )));
    Estimator {
        tick: any_flow::<S, TAPS>(s, 1, limit),
        ahead: any_flow::<S, UNDER_WAY>(s, 2, limit),
        correction: [weight(s, one), weight(s, 2 * one), weight(s, 2 * one)],
        limit,
    }
}

/// Whether the weights (coefficients) are within what settings can give. The code checks it with [`Estimator::is_bounded`] when it
/// calculates the coefficients (`p8_estimator_bounded32`).
pub fn ok(estimator: &Estimator<N>) -> bool {
    let limit = i64::from(estimator.limit.0.to_bits());
    let [position, moved, pushed] = estimator.correction;
    limit >= 0
        && flow_ok(&estimator.tick, 1, limit)
        && flow_ok(&estimator.ahead, 2, limit)
        && (0..=ONE).contains(&position)
        && (0..=2 * ONE).contains(&moved)
        && (0..=2 * ONE).contains(&pushed)
}

/// Any estimated motion; in random tests mostly one within the invariant.
pub fn any_motion<S: Source>(s: &mut S) -> EstimatedMotion<N> {
    let mut state = |bits: u32| {
        let any = s.i64();
        // Limits samples to ±2^bits at once; not for a proof.
        Wide64(if s.shortcut() { any >> (9 - bits) } else { any })
    };
    EstimatedMotion {
        position: state(7),
        moved: state(2),
        pushed: state(2),
    }
}

/// The invariant of an estimated motion: position within 136 rad, displacement below 4 rad per tick, the hand's push (an
/// acceleration) below 4 rad per tick².
pub fn holds(motion: &EstimatedMotion<N>) -> bool {
    motion.position.0.unsigned_abs() <= 136 * RAD.unsigned_abs()
        && motion.moved.within(2)
        && motion.pushed.within(2)
}

/// A list of past commands, each with any value within the force limit.
pub fn any_commands<S: Source>(s: &mut S, limit: Force<N>) -> [i32; TAPS] {
    let most = limit.0.to_bits().max(0);
    core::array::from_fn(|_| s.i32().clamp(-most, most))
}

/// Any measured position. In random tests some are near the expected position; otherwise the estimator would almost always restart
/// and hardly ever correct.
pub fn any_measured<S: Source>(s: &mut S, before: &EstimatedMotion<N>) -> Position<N> {
    if !s.bool() {
        return Position(fixed::types::I8F24::from_bits(s.i32()));
    }
    let away = Position(fixed::types::I8F24::from_bits(s.i32() >> 8));
    Position(N::narrow(before.position)) - away
}

limited_property! {
    /// P8 (settings): the code's check of new coefficients (`is_bounded`) is the same condition as these properties assume of an
    /// estimator.
    equation "is_bounded = (V, X <= t, βV <= 1, Σ q f < 2 t, 0 <= α <= 1, 0 <= β, γ <= 2)"
    over "weights and limit"
    by minisat fn p8_estimator_bounded32(s) {
        let law = any(s);
        let found = law.is_bounded();
        reckoned::of_specification();
        assert!(found == ok(&law));
        cover!(s, found & (law.limit.0.to_bits() > 1 << 24), "bounded");
        cover!(s, !found & (law.limit.0.to_bits() > 1 << 24), "not bounded");
    }
}
property! {
    /// P3 (no overflow): no sum of a prediction overflows, from any motion in the invariant and under any commands within the
    /// limit. The predicted position is below 160 rad, the displacement below 21 rad per tick.
    equation "|x + V d + X g - Σ q f| < 160 rad"
    over "weights as settings give them, motion in the invariant, commands"
    by minisat fn p3_flow_fits32(s) {
        let law = such!(s, any(s), |law| ok(&law), "settings");
        let motion = such!(s, any_motion(s), |motion| holds(&motion), "invariant, kept by p3_motion_stays32");
        let commands = any_commands(s, law.limit);
        for (position, moved) in [law.tick.apply(&motion, &commands), law.ahead.apply(&motion, &commands)] {
            assert!(position.0.unsigned_abs() < 160 * RAD.unsigned_abs());
            assert_reached!(moved.0.unsigned_abs() < 21 * RAD.unsigned_abs());
        }
        cover!(s, motion.position.0 > 127 * RAD, "at the end of the range");
        cover!(s, motion.moved.0 < -3 * RAD && motion.pushed.0 < -3 * RAD, "fast and pushed");
    }
}
bounded_property! {
    /// P3 (no overflow): a correction keeps the invariant, or the estimator restarts at the measured position; no sum overflows.
    /// The corrected position is at most as far from the measured position as the predicted one was. This holds for any result of
    /// the prediction that `p3_flow_fits32` allows.
    equation "|x' - e| <= |e - x⁻|, invariant"
    over "weights as settings give them, motion in the invariant, commands, measured position"
    by minisat fn p3_motion_stays32(s) {
        let law = such!(s, any(s), |law| ok(&law), "settings");
        let before = such!(s, any_motion(s), |motion| holds(&motion), "invariant, kept by this");
        let commands = any_commands(s, law.limit);
        let measured = any_measured(s, &before);
        let after = law.corrected(&before, &commands, measured);
        let (expected, _) = law.tick.apply(&before, &commands);
        if let Some(after) = after {
            assert!(holds(&after));
            let surprise = N::widen(measured.0).minus_fitting(expected);
            let rest = N::widen(measured.0).minus_fitting(after.position);
            // A part is rounded down, so it can be wrong by one step.
            assert_reached!(rest.0.unsigned_abs() <= surprise.0.unsigned_abs() + (1 << 26));
        }
        cover!(s, after.is_some_and(|after| after.position != expected), "corrected");
        cover!(s, after.is_none(), "starts anew");
    }
}
property! {
    /// P2 (rounding): at rest the state does not change, and the result is the measured position. At rest means: the measured
    /// position equals the predicted one, the device does not move, the hand does not push, and no force is commanded.
    equation "x = e, d = g = f = 0  =>  shown (e, 0), nothing changes"
    over "weights as settings give them, measured position"
    by minisat fn p2_rest_stays32(s) {
        let law = such!(s, any(s), |law| ok(&law), "settings");
        let measured = Position(fixed::types::I8F24::from_bits(s.i32()));
        let motion = EstimatedMotion::<N> { position: N::widen(measured.0), ..EstimatedMotion::default() };
        let mut state = touchstone_control::estimator::EstimatorState { motion: Some(motion), commands: [0; TAPS] };
        let sample = law.tick(&mut state, measured);
        assert!(sample == Sample { e: measured, moved: Position::zero() });
        assert!(state.motion == Some(motion));
        cover!(s, measured.0.to_bits() == i32::MIN, "lowest position");
    }
}
property! {
    /// P2 (rounding): a position that becomes a wide state and a position again is unchanged. A state becomes the nearest position,
    /// or the end of the range.
    equation "narrow(widen(x)) = x, |2^30 narrow(w) - w| <= 2^29"
    over "signal, state"
    by cadical fn p2_narrow32(s) {
        let signal = fixed::types::I8F24::from_bits(s.i32());
        assert!(N::narrow(N::widen(signal)) == signal);
        assert!(N::widen(signal).torque_part() == signal.to_bits());
        let state = Wide64(s.i64());
        let shown = i128::from(N::narrow(state).to_bits()) << 30;
        let (lowest, highest) = (i128::from(i32::MIN) << 30, i128::from(i32::MAX) << 30);
        let nearest = (shown - i128::from(state.0)).unsigned_abs() <= 1 << 29;
        let beyond = (shown == highest && i128::from(state.0) > highest)
            || (shown == lowest && i128::from(state.0) < lowest);
        assert!(nearest || beyond);
        cover!(s, beyond && state.0 > 0, "above the range");
        cover!(s, nearest && shown != i128::from(state.0), "rounded");
    }
}
