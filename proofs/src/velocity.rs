//! P11 (refinement): the velocity filters of a spring-damper equal their specification (`spec/velocity.rs`), and none of their
//! states leaves its range.
//!
//! A product of a weight (coefficient) and a part (leading digits of a state) is replaced, as for the estimator
//! ([`crate::weighed`]). Where code and specification are compared, it is one unknown number for both; where only its range
//! matters, it is any number in that range. The window multiplies by whole ticks. It is compared in random tests, like everything
//! else (`proofs/tests/spec_velocity.rs`).
//!
//! `v` is the filtered displacement per tick, `x` the position, `a` the gain. In `x - x'` the last position is `x'`; elsewhere `'`
//! marks the new value.
//!
//! ```text
//! v' = v + a (x - x' - v) = spec               p11_smoothed, its range p3_smoothed_stays32
//! a tick without brake and drive is 1, 1/2, 0  p11_free
//! tracker = spec, a device without damping      p11_tracker; its sums are estimator::p3_flow_fits32's of no command
//! ```

use crate::estimated::motion;
use crate::estimator::{any_measured, any_motion, holds};
use crate::format::Format;
use crate::source::one_with;
use crate::spec::Int;
use crate::spec::velocity as spec;
use crate::valid::Valid;
use crate::{
    bounded_property, cover, property, replaced_property, such, weighed, weighed_property,
};
use fixed::FixedI32;
use touchstone_control::estimator::Flow;
use touchstone_control::law::{Damped, DampedState, Law as _, Sample, Spring};
use touchstone_control::number::Wide64;
use touchstone_control::velocity::{
    FirstOrderAdaptiveWindow, LONGEST_WINDOW, Slope, Smoothed, Tracker, Velocity,
};
use touchstone_control::{Fixed8, Fixed32, Force, Position, Ratio, Stiffness};

type N = Fixed32;

/// The value 1 as a weight (coefficient) of motion, with 26 fractional bits.
const ONE: i32 = 1 << 26;
const RAD: i64 = 1 << Wide64::FRACTION;

/// A weight (coefficient) with any bits; in random tests mostly one from 0 to `most`.
fn weight<S: crate::source::Source>(s: &mut S, most: i32) -> i32 {
    let any = s.i32();
    if s.shortcut() {
        any.rem_euclid(most + 1)
    } else {
        any
    }
}

weighed_property! {
    /// P11 (refinement): the first-order filter of position differences equals the specification's; both restart on the same
    /// inputs.
    equation "d' = d + a (x - x' - d); none beyond 8 rad of news or 4 rad a tick"
    over "weight, motion in the invariant, measured position"
    by minisat fn p11_smoothed(s) {
        let law = Smoothed::<N> { share: weight(s, ONE) };
        let before = such!(s, any_motion(s), |motion| holds(&motion), "invariant, kept by p3_smoothed_stays32");
        let measured = any_measured(s, &before);
        let after = law.tick(&before, measured);
        weighed::of_specification();
        let expected = spec::smoothed(law.share.into(), motion(&before), measured.0.to_bits().into());
        assert!(after.as_ref().map(motion) == expected);
        cover!(s, expected.is_some_and(|after| after.d < 0), "outward");
        cover!(s, expected.is_none(), "starts anew");
    }
}
bounded_property! {
    /// P3 (no overflow): a first-order filter with a gain up to 1 keeps its state within the invariant, and none of its sums
    /// overflows.
    equation "|d'| <= 4 rad, x' = e, g' = g"
    over "share from 0 to 1, motion in the invariant, measured position"
    by minisat fn p3_smoothed_stays32(s) {
        let law = such!(s, Smoothed::<N> { share: weight(s, ONE) }, |law| (0..=ONE).contains(&law.share), "1 - exp(-a), of which no weight is more");
        let before = such!(s, any_motion(s), |motion| holds(&motion), "invariant, kept here");
        let measured = any_measured(s, &before);
        let after = law.tick(&before, measured);
        if let Some(after) = &after {
            assert!(holds(after));
            assert!(after.position.0 == i64::from(measured.0.to_bits()) << 30 && after.pushed == before.pushed);
            assert_reached!(after.moved.0.unsigned_abs() <= 4 * RAD.unsigned_abs());
        }
        cover!(s, after.is_none(), "starts anew");
        cover!(s, after.is_some_and(|after| after.moved.0 < -RAD), "fast");
    }
}
property! {
    /// P11 (refinement): the prediction that the Kalman filters use, without damping and commands, is exact. A displacement per
    /// tick adds itself to the position, an acceleration adds half of itself.
    equation "V = 1, X = 1/2, β V = 0"
    over "nothing"
    by cadical fn p11_free(s) {
        let free = Flow::<N, 0>::free();
        let found = free.map(|free| [free.reach, free.drift, free.loss].map(Int::from));
        assert!(found == Some([ONE.into(), (ONE / 2).into(), 0]));
        cover!(s, free.is_some(), "made");
    }
}
weighed_property! {
    /// P11 (refinement): a velocity filter with constant Kalman gains equals the specification's; both restart on the same inputs.
    equation "r = e - x - V d - X g; (x', d', g') = (x⁻, d⁻, g) + (α, β, γ) r"
    over "weights, motion in the invariant, measured position"
    by minisat fn p11_tracker(s) {
        let law = Tracker::<N> {
            free: Flow { reach: weight(s, ONE), drift: weight(s, ONE), loss: 0, commands: [] },
            correction: [weight(s, ONE), weight(s, 2 * ONE), weight(s, 2 * ONE)],
        };
        let before = such!(s, any_motion(s), |motion| holds(&motion), "invariant, kept by estimator::p3_motion_stays32");
        let measured = any_measured(s, &before);
        let after = law.tick(&before, measured);
        weighed::of_specification();
        let (reach, drift) = (law.free.reach.into(), law.free.drift.into());
        let gains = law.correction.map(Int::from);
        let expected = spec::tracked(reach, drift, gains, motion(&before), measured.0.to_bits().into());
        assert!(after.as_ref().map(motion) == expected);
        cover!(s, expected.is_some_and(|after| after.d < 0 && after.g > 0), "corrected");
        cover!(s, expected.is_none(), "starts anew");
    }
}

/// The coefficients for the slope over a window of this many ticks, as settings give them.
fn slope(ticks: i32) -> Slope<N> {
    Slope {
        times: Stiffness(FixedI32::from_bits(ticks << 12)),
        share: Ratio(FixedI32::from_bits((1 << 24) / ticks)),
    }
}
fn place(bits: i32) -> Position<N> {
    Position(FixedI32::from_bits(bits))
}

property! {
    /// P11 (refinement): adaptive windowing equals the specification's, in its result and in the remembered positions. The result
    /// is the slope over the longest window that a line fits.
    equation "v = (e - e(n-k))/k, the largest k <= K that a line within d fits; e, e(n-1), ... remembered"
    over "positions remembered, position, longest window, margin"
    by sampled fn p11_window(s) {
        let longest = s.u8() % 17;
        let slopes = core::array::from_fn(|at| slope(at as i32 + 1));
        let law = FirstOrderAdaptiveWindow { slopes, longest, margin: place(s.i32()) };
        let at = s.i32();
        let before: [i32; LONGEST_WINDOW] = core::array::from_fn(|_| s.i32());
        let mut past = before.map(place);
        let found = law.tick(&mut past, place(at));
        let margin = law.margin.0.to_bits().into();
        let expected = spec::window(&before.map(Int::from), at.into(), longest.into(), margin);
        assert!(Int::from(found.0.to_bits()) == expected);
        for n in 1..LONGEST_WINDOW {
            assert_reached!(past[n] == place(before[n - 1]));
        }
        assert!(past[0] == place(at));
        cover!(s, expected < 0, "outward");
        cover!(s, expected > 0 && longest == 16, "inward");
    }
}
replaced_property! {
    [(touchstone_control::velocity::Velocity::tick, crate::velocity::any_velocity)]
    /// P11 (refinement): a spring-damper with a velocity filter is the spring-damper with the penetration and the velocity that the
    /// filter gives.
    equation "f = spring(e, v), v = filter(e)"
    over "spring and damper, penetration, displacement told; under the checker whatever a filter tells"
    by kissat fn p11_damped_tick(s) {
        let spring = one_with(s, <Spring<Fixed8> as Valid<Fixed8>>::any, Spring::valid);
        let velocity = Velocity::Smoothed(Smoothed { share: s.i32() & (ONE - 1) });
        let law = Damped { spring, velocity };
        let mut state = DampedState { spring: <Spring<Fixed8> as Valid<Fixed8>>::any_state(s), ..DampedState::default() };
        let (mut own, mut filtered) = (state.spring, state.velocity);
        let sample = Sample { e: Fixed8::any_position(s), moved: Fixed8::any_position(s) };
        let force = law.tick(&mut state, sample);
        let moved = velocity.tick(&mut filtered, sample.e);
        assert!(force == spring.tick(&mut own, Sample { moved, ..sample }));
        assert!(state == DampedState { spring: own, velocity: filtered });
        cover!(s, force > Force::zero() && sample.e > Position::zero(), "pushes");
    }
}

/// Replaces `Velocity::tick` when the model checker runs: any displacement for a position, and the same one for an equal position.
#[cfg(kani)]
pub fn any_velocity<N: Format>(
    _: &Velocity<N>,
    state: &mut touchstone_control::velocity::VelocityState<N>,
    at: Position<N>,
) -> Position<N> {
    use core::sync::atomic::{AtomicI64, Ordering::Relaxed};
    static ASKED: [AtomicI64; 2] = [const { AtomicI64::new(i64::MAX) }; 2];
    let told = N::any_position(&mut crate::source::Symbolic);
    let words = [at, told].map(|x| N::of_signal(x.0));
    kani::assume(ASKED[0].load(Relaxed) != words[0] || ASKED[1].load(Relaxed) == words[1]);
    for (place, word) in ASKED.iter().zip(words) {
        place.store(word, Relaxed);
    }
    *state = touchstone_control::velocity::VelocityState::Positions([told; LONGEST_WINDOW]);
    told
}
