//! P11 (refinement): a tick of the state estimator is a tick of its specification (`spec/estimator.rs`), with results and the whole
//! memory.
//!
//! Each product of a weight (coefficient) and a part (leading digits of a state) is one unknown number for code and specification
//! ([`crate::weighed`]). So the properties hold for any weights for which no sum overflows; `estimator::p3_*` prove that for the
//! weights that settings give.
//!
//! `x`, `d`, `g` are position, displacement per tick and the hand's push (an acceleration), `f` the commands, `e` the measured
//! position.
//!
//! ```text
//! apply(x, d, g, f) = spec(x, d, g, f)         p11_estimator_flow, p11_estimator_ahead
//! tick(memory, e) = spec(memory, e)            p11_estimator_tick, its correction p11_estimator_corrected
//! commanded(memory, f) = spec(memory, f)       p11_estimator_commanded
//! ```

use crate::estimator::{any, any_commands, any_measured, any_motion, holds, ok};
use crate::spec::Int;
use crate::spec::estimator as spec;
use crate::{
    corrected_property, cover, flowed_property, property, such, weighed, weighed_property,
};
use touchstone_control::estimator::{EstimatedMotion, EstimatorState, Flow};
use touchstone_control::{Estimator, Fixed32, Force};

type N = Fixed32;

/// Converts a prediction (state transition over a time) to the specification's type.
#[must_use]
pub fn flow<const COMMANDS: usize>(flow: &Flow<N, COMMANDS>) -> spec::Flow<COMMANDS> {
    spec::Flow {
        reach: flow.reach.into(),
        drift: flow.drift.into(),
        loss: flow.loss.into(),
        commands: flow.commands.map(|weights| weights.map(Int::from)),
    }
}
/// Converts the estimator's coefficients to the specification's type.
#[must_use]
pub fn specified(law: &Estimator<N>) -> spec::Estimator {
    spec::Estimator {
        tick: flow(&law.tick),
        ahead: flow(&law.ahead),
        correction: law.correction.map(Int::from),
        limit: law.limit.0.to_bits().into(),
    }
}
/// Converts an estimated motion to the specification's type.
#[must_use]
pub fn motion(of: &EstimatedMotion<N>) -> spec::Motion {
    spec::Motion {
        x: of.position.0.into(),
        d: of.moved.0.into(),
        g: of.pushed.0.into(),
    }
}
/// Converts the estimator's memory to the specification's type.
#[must_use]
pub fn memory(of: &EstimatorState<N>) -> spec::Memory {
    spec::Memory {
        motion: of.motion.as_ref().map(motion),
        commands: of.commands.map(Int::from),
    }
}

weighed_property! {
    /// P11 (refinement): the estimator's prediction from one sample to the next, with three commands, equals the specification's.
    equation "(x⁻, d⁻) = spec(x, d, g, f)"
    over "weights, motion in the invariant, commands"
    by minisat fn p11_estimator_flow(s) {
        let law = such!(s, any(s), |law| cfg!(kani) || ok(&law), "settings; of all others that no sum of theirs overflows");
        let from = such!(s, any_motion(s), |motion| holds(&motion), "invariant, kept by estimator::p3_motion_stays32");
        let commands = any_commands(s, law.limit);
        let (position, moved) = law.tick.apply(&from, &commands);
        weighed::of_specification();
        let expected = specified(&law).tick.end(motion(&from), commands.map(Int::from));
        assert!((Int::from(position.0), Int::from(moved.0)) == expected);
        cover!(s, expected.0 < Int::from(from.position.0) && expected.1 > 0, "outward, and slower");
    }
}
weighed_property! {
    /// P11 (refinement): the estimator's prediction from a sample to the time at which the next command acts, with two commands,
    /// equals the specification's.
    equation "(x, d) = spec(x, d, g, f)"
    over "weights, motion in the invariant, commands"
    by minisat fn p11_estimator_ahead(s) {
        let law = such!(s, any(s), |law| cfg!(kani) || ok(&law), "settings; of all others that no sum of theirs overflows");
        let from = such!(s, any_motion(s), |motion| holds(&motion), "invariant, kept by estimator::p3_motion_stays32");
        let commands = any_commands(s, law.limit);
        let (position, moved) = law.ahead.apply(&from, &commands);
        weighed::of_specification();
        let expected = specified(&law).ahead.end(motion(&from), commands.map(Int::from));
        assert!((Int::from(position.0), Int::from(moved.0)) == expected);
        cover!(s, expected.0 < Int::from(from.position.0) && expected.1 > 0, "outward, and slower");
    }
}
flowed_property! {
    /// P11 (refinement): the correction of an estimated motion by a measured position equals the specification's; both restart on
    /// the same inputs.
    equation "(x', d', g') = spec(x, d, g, f, e)"
    over "weights, motion in the invariant, commands, measured position"
    by minisat fn p11_estimator_corrected(s) {
        let law = such!(s, any(s), |law| cfg!(kani) || ok(&law), "settings; of all others that no sum of theirs overflows");
        let before = such!(s, any_motion(s), |motion| holds(&motion), "invariant, kept by estimator::p3_motion_stays32");
        let commands = any_commands(s, law.limit);
        let measured = any_measured(s, &before);
        let after = law.corrected(&before, &commands, measured);
        weighed::of_specification();
        let expected = specified(&law).corrected(motion(&before), commands.map(Int::from), measured.0.to_bits().into());
        assert!(after.as_ref().map(motion) == expected);
        cover!(s, expected.is_some_and(|after| after.d < 0 && after.g > 0), "corrected");
        cover!(s, expected.is_none(), "starts anew");
    }
}
corrected_property! {
    /// P11 (refinement): a tick of the state estimator equals the specification's, with results and memory.
    equation "(memory', e', Δe') = spec(memory, e)"
    over "weights, memory in the invariant or before the first sample, measured position"
    by minisat fn p11_estimator_tick(s) {
        let law = such!(s, any(s), |law| cfg!(kani) || ok(&law), "settings; none of this harness");
        let before = such!(s, any_motion(s), |motion| holds(&motion), "invariant, kept by estimator::p3_motion_stays32");
        let measured = any_measured(s, &before);
        let first = s.bool();
        let mut state = EstimatorState { motion: if first { None } else { Some(before) }, commands: any_commands(s, law.limit) };
        let remembered = memory(&state);
        let sample = law.tick(&mut state, measured);
        weighed::of_specification();
        let (after, e, moved) = specified(&law).tick(&remembered, measured.0.to_bits().into());
        assert!(memory(&state) == after);
        assert!(Int::from(sample.e.0.to_bits()) == e && Int::from(sample.moved.0.to_bits()) == moved);
        cover!(s, first, "first sample");
        cover!(s, e == (1 << 31) - 1 && moved < 0, "beyond the format");
        cover!(s, !first && after.motion.is_some_and(|motion| motion.d != 0), "moves");
    }
}
property! {
    /// P11 (refinement): a commanded force, limited to the largest, becomes the latest of the estimator's remembered commands.
    equation "f' = (min(max(f, -limit), limit), f_1, f_2)"
    over "limit not negative, memory, force"
    by cadical fn p11_estimator_commanded(s) {
        let law = such!(s, any(s), |law| law.limit >= Force::zero(), "settings");
        let moved = any_motion(s);
        let mut state = EstimatorState { motion: s.bool().then_some(moved), commands: [s.i32(), s.i32(), s.i32()] };
        let expected = memory(&state);
        let force = Force(fixed::types::I8F24::from_bits(s.i32()));
        law.commanded(&mut state, force);
        let expected = specified(&law).commanded(&expected, force.0.to_bits().into());
        assert!(memory(&state) == expected);
        cover!(s, force < -law.limit, "below the limit");
        cover!(s, force > Force::zero() && force < law.limit, "within");
    }
}
