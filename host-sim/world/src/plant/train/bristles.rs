//! LuGre friction (dry friction modelled by elastic bristles) over a substep.

use super::friction::{LuGre, level};

/// Advances the bristles' deflection `z` over a substep. Returns their mean torque against the positive direction, N·m.
///
/// The rate `a = s0 |v|/g` is held constant during the substep, with bristle stiffness `s0`, velocity `v` and friction level `g`.
/// Then `z' = v - a z` is solved exactly for the substep's mean velocity, and the torque is computed together with that velocity.
/// Stiff bristles and fast sliding therefore need no short substeps for stability. A first pass with the initial velocity gives the
/// mean velocity at which the rate is evaluated.
#[inline(always)]
pub(super) fn advance(
    lugre: &LuGre,
    [before, free]: [f64; 2],
    response: f64,
    bristle: &mut f64,
    substep_s: f64,
) -> f64 {
    let first = solve(lugre, before, [before, free], response, *bristle, substep_s);
    let second = solve(
        lugre,
        first.mean_v,
        [before, free],
        response,
        *bristle,
        substep_s,
    );
    *bristle = second.bristle;
    second.torque
}

struct Solved {
    torque: f64,
    mean_v: f64,
    bristle: f64,
}

#[inline(always)]
fn solve(
    lugre: &LuGre,
    rate_v: f64,
    [before, free]: [f64; 2],
    response: f64,
    bristle: f64,
    substep_s: f64,
) -> Solved {
    let sliding = &lugre.directions[usize::from(rate_v < 0.0)];
    let g = level(sliding, lugre.stribeck, rate_v);
    let turns = lugre.stiffness * rate_v.abs() * substep_s / g;
    let left = libm::exp(-turns);
    // Time for which the mean velocity stretches the bristles, s: `h (1 - e^{-ah})/(ah)`.
    let stretch_s = if turns > 1e-8 {
        -substep_s * libm::expm1(-turns) / turns
    } else {
        substep_s
    };
    // The deflection at the end is `left z + stretch v`. The torque follows from the mean deflection and its mean rate: `held +
    // per_v v`.
    let rate = lugre.damping / substep_s;
    let held = bristle * (0.5 * lugre.stiffness * (1.0 + left) - rate * (1.0 - left));
    let per_v = stretch_s * (0.5 * lugre.stiffness + rate);
    let free_mean = 0.5 * (before + free);
    let torque = (held + per_v * free_mean) / (1.0 + 0.5 * per_v * response);
    let mean_v = free_mean - 0.5 * response * torque;
    Solved {
        torque,
        mean_v,
        bristle: left * bristle + stretch_s * mean_v,
    }
}
