//! Specification of `Guard::new`, line by line as in `proofs/coq/GuardSettings.v`. The theorems there state that accepted settings
//! satisfy what the guard's properties assume, and what the energy theorem requires for the given device.

use super::guard::Guard;
use super::settings::{
    MOST, ONE, between, energy_fits, energy_of, gain_fits, gain_of, over, plus, signal_fits,
    signal_of, times,
};
use super::{HIGHEST, Int};

/// Settings of the guard as integers, in units of 2^-32 of their SI units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Settings {
    /// Most energy that the account holds, J.
    pub capacity: Int,
    /// Power that refills the energy account, W.
    pub refill: Int,
    /// Fraction (0 to 1) of the damping that is trusted.
    pub share: Int,
    /// Damping of the device without a hand, N·m·s/rad.
    pub damping: Int,
    /// Speed above which the guard switches the force off, rad/s.
    pub overspeed: Int,
    /// Delay from a sample until its force begins to act, s.
    pub delay: Int,
    /// Mean lag of the current loop after that delay, s.
    pub lag: Int,
    /// Whether the position is also read when the force changes.
    pub measured: bool,
}

/// Properties of the device that the guard's coefficients depend on, as integers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Told {
    /// Control rate, a whole number of Hz.
    pub rate: Int,
    /// Force limit, N·m, in units of 2^-32.
    pub limit: Int,
    /// Angle of an encoder count, rad, in units of 2^-32.
    pub count: Int,
}

/// A margin for bounds, in units of 2^-32. It exceeds the rounding error of a sum of products and quotients.
const UP: Int = 8;
/// One step of the format of positions and forces, in units of 2^-32.
const STEP: Int = 1 << 8;
/// The largest force for which the energy account has room, 31.9 N·m in units of 2^-32.
const ROOM: Int = 137_009_456_742;

fn quarter_fits(x: Int) -> bool {
    signal_fits((x * 4).min(MOST))
}
fn signal_plus(a: Int, b: Int) -> Int {
    (a + b).min(HIGHEST)
}
/// A position in the 32-bit format of positions, rounded up.
fn signal_up(x: Int) -> Int {
    signal_plus(signal_of(x), 1)
}

fn rate(told: &Told) -> Int {
    (told.rate * ONE).min(MOST)
}

/// The settings with the sum of delay and lag limited to one tick, rounded down. Accepted settings can exceed a tick by at most
/// 2^-32 s.
fn within_a_tick(set: &Settings, told: &Told) -> Settings {
    let tick = over(ONE, rate(told));
    let delay = set.delay.min(tick);
    let lag = set.lag.min(tick - delay);
    Settings { delay, lag, ..*set }
}

/// Whether `validate` accepts the guard's settings for this device.
#[must_use]
pub fn in_ranges(set: &Settings, told: &Told) -> bool {
    let each = between(0, set.capacity, 16 * ONE)
        && between(0, set.refill, ONE)
        && between(0, set.damping, 1000 * ONE)
        && between(0, set.share, ONE)
        && between(4_294_967, set.overspeed, 1000 * ONE)
        && between(0, set.delay, ONE)
        && between(0, set.lag, ONE)
        && between(1, told.rate, 100_000)
        && between(0, told.limit, 1000 * ONE)
        && between(0, told.count, 429_496_730);
    if !each {
        return false;
    }
    // Settings are rounded to the nearest digit, while this quotient is rounded down.
    let tick = over(ONE, rate(told)) + 1;
    between(0, set.delay, tick) && between(0, set.lag, tick - set.delay)
}

/// The two warnings for settings within their ranges, each `true` if it applies. First: the capacity is less than the work of the
/// largest force over the sum of the largest displacement, its part after the next sample, and half a count. Second: the account is
/// never refilled.
#[must_use]
pub fn warned(set: &Settings, told: &Told) -> [bool; 2] {
    let set = within_a_tick(set, told);
    let rate = rate(told);
    let distance = plus(plus(over(set.overspeed, rate), told.count), UP);
    let reach = plus(distance, told.count);
    let late = times(plus(set.delay, set.lag), rate);
    let over_a_tick = times(times(told.limit, reach), plus(ONE, late));
    let needed = plus(over_a_tick, times(told.limit, told.count) / 2);
    [set.capacity < needed, set.refill == 0]
}

/// The guard for settings within their ranges; `None` if a coefficient does not fit.
#[must_use]
pub fn made(set: &Settings, told: &Told) -> Option<Guard> {
    let set = within_a_tick(set, told);
    let rate = rate(told);
    let tick = over(ONE, rate);
    let measured = over(set.overspeed, rate);
    let refill = over(set.refill, rate);
    let trusted = times(set.share, set.damping);
    let damping = times(trusted, rate);
    // The measured displacement of a tick may be a count longer than the true one.
    let distance = plus(plus(measured, told.count), UP);
    let reach = plus(distance, told.count);
    let late = times(plus(set.delay, set.lag), rate);

    // The energy in flight is rounded up by a little more than one step of the number format. Each of the two positions in it is
    // rounded up by one more step.
    let rounded = plus(plus(plus(STEP, STEP), STEP), UP);
    let per_reach = over(ONE, plus(reach, rounded)).min(over(ROOM, set.capacity));
    let largest_change = (plus(times(set.capacity, per_reach), UP) * 2).min(MOST);

    // `mean`: mean time for which the old force still acts. `span`: the time in which it may act.
    let (span, mean) = if set.measured {
        (tick - set.delay, set.lag)
    } else {
        (tick, plus(set.delay, set.lag))
    };
    let (share, split) = if mean > 0 {
        let share = over(mean, span).min(ONE);
        (share, plus(times(share, (span - mean).max(0)), UP))
    } else {
        (0, 0)
    };
    let stray = if split > 0 {
        over(split, (trusted * 4).min(MOST))
    } else {
        0
    };

    let half_count = told.count >> 1;
    let left_out = plus(plus(largest_change, distance), set.overspeed >> 8);
    // Half a count, plus what rounding leaves out: one step of the format for every whole unit of `left_out`, and one for the rest.
    let half_count_up = plus(half_count, STEP * ((left_out >> 32).min(0xffff) + 1));
    // The position and its part under the old force are each rounded by one step of the format.
    let slack = signal_plus(signal_plus(signal_up(half_count_up), 1), 1);
    // A measured position at the change of force is rounded by one more step.
    let slack = signal_plus(slack, i128::from(set.measured));
    let in_flight = if set.delay > 0 || set.lag > 0 {
        plus(plus(times(late, distance), UP), half_count)
    } else {
        half_count
    };
    let overrun = over(plus(plus(late, UP), ONE), (damping * 4).min(MOST));
    let overrun = if signal_fits(overrun) {
        overrun
    } else {
        127 * ONE
    };

    let fits = signal_fits(told.limit)
        && quarter_fits(set.capacity)
        && quarter_fits(times(damping, distance))
        && quarter_fits(distance)
        && quarter_fits(refill)
        && quarter_fits(times(stray, largest_change))
        && signal_fits(half_count_up)
        && quarter_fits(plus(in_flight, rounded))
        && energy_fits(set.capacity)
        && energy_fits(refill)
        && gain_fits(damping)
        && signal_fits(measured)
        && signal_fits(told.count)
        && signal_fits(share)
        && signal_fits(stray)
        && gain_fits(per_reach)
        && signal_fits(in_flight);
    fits.then(|| Guard {
        capacity: energy_of(set.capacity),
        refill: energy_of(refill),
        damping: gain_of(damping),
        furthest: signal_of(measured),
        count: signal_plus(signal_plus(signal_up(told.count), 1), 1),
        late: signal_of(share),
        stray: signal_of(stray),
        slack,
        per_reach: gain_of(per_reach),
        in_flight: signal_plus(signal_up(in_flight), 1),
        overrun: signal_of(overrun),
    })
}
