//! Simulates the port between hand and device, with a torque profile as the law and the energy guard of its environment. Also makes
//! hostile profiles.

use super::{Hand, Outcome, Port, TICK_S};
use crate::environment::{COUNT_RAD, at, built};
use crate::random::Random;
use touchstone_control::environment::{
    Environment, Extent, MOST_POINTS, ProfileSettings, Reading, Shape, WHOLE,
};
use touchstone_control::{
    ChangeOfForce, Fixed32, Force, LawKind, Position, Settings, Si, StatesKind,
};

/// Largest torque of the profiles and force limit, N·m.
pub const STRENGTH_N_M: f64 = 0.3;

/// Step of a 32-bit position, to which the environment rounds positions before its guard gets their differences.
const STEP: Si = Si::from_bits(1 << 8);

fn environment(port: &Port, profile: &ProfileSettings) -> Environment<Fixed32> {
    let mut settings = Settings {
        law: LawKind::Spring,
        states: StatesKind::Measured,
        force_limit: Si::from_num(port.force_limit_n_m),
        ..Settings::thesis()
    };
    settings.position.count = port.device().count;
    settings.guard.on = port.guard.is_some();
    if let Some(guard) = port.guard {
        settings.guard = touchstone_control::GuardSettings { on: true, ..guard };
    }
    built::<Fixed32>(&settings, &[], None)
        .with_profile(profile, settings.force_limit)
        .unwrap_or_else(|error| panic!("{error}"))
}

/// The displacement between two counts, as the environment's guard gets it; `None` beyond 128 rad.
fn way(from: i64, to: i64) -> Option<Position<Fixed32>> {
    let [from, to] = [from, to].map(|count| Reading::<Fixed32>::on_steps(&at(count), STEP));
    Position::from_si(to.saturating_sub(from))
}

/// Simulates a hand at a profile for this many control periods. The energy is summed in `f64` from the true motion.
///
/// # Panics
/// The profile is refused.
pub fn play(port: &Port, profile: &ProfileSettings, hand: &mut impl Hand, ticks: u32) -> Outcome {
    let mut felt = environment(port, profile);
    let measured = (port.guard).is_some_and(|it| it.change == ChangeOfForce::Measured);
    let refill_w: f64 = port.guard.map_or(0.0, |it| it.refill.to_num());
    let counted = |x: f64| (x / COUNT_RAD).round() as i64;
    let (early_s, late_s) = (port.delay_ticks * TICK_S, (1.0 - port.delay_ticks) * TICK_S);
    let account = |felt: &Environment<Fixed32>| felt.guard.map_or(0.0, |it| it.account().to_f64());
    let mut x = hand.start();
    let mut told = counted(x);
    let mut at_change = told;
    let mut acting = 0.0;
    let (mut out, mut lowest, mut lowest_above) = (0.0_f64, 0.0_f64, 0.0_f64);
    let mut outcome = Outcome {
        lowest_account_j: account(&felt),
        ..Outcome::default()
    };
    // The two largest energies at the beginning of the last tick that was run.
    let mut settled = (0.0, 0.0);
    for tick in 0..ticks {
        let now = counted(x);
        let since = measured.then(|| way(at_change, now)).flatten();
        let ways = [way(told, now), way(told, at_change)];
        told = now;
        let force = felt.tick(&at(now), since);
        if let Some(guard) = &felt.guard {
            // The guard's bound does not cover the energy of an over-speed, so only `with_overspeed_j` includes it.
            let is_far = |way: &Position<Fixed32>| way.modulus() > guard.guard.furthest;
            if ways.iter().any(|way| way.as_ref().is_none_or(is_far)) {
                outcome.with_overspeed_j = outcome.above_refill_j;
                (outcome.worst_window_j, outcome.above_refill_j) = settled;
                break;
            }
            outcome.changed_ticks += u32::from(guard.limited);
            outcome.lowest_account_j = outcome.lowest_account_j.min(account(&felt));
        }
        settled = (outcome.worst_window_j, outcome.above_refill_j);
        let mut refilled = refill_w * TICK_S * f64::from(tick);
        lowest = lowest.min(out);
        lowest_above = lowest_above.min(out - refilled);
        let new = Force::to_f64(force);
        outcome.changes_n_m += (new - acting).abs();
        for (late, force, seconds) in [(false, acting, early_s), (true, new, late_s)] {
            if seconds > 0.0 {
                let (to, damped) = hand.go(tick, late, force, seconds);
                out -= force * (to - x) + damped;
                x = to;
            }
            if !late {
                at_change = counted(x);
            }
            refilled += refill_w * seconds;
            outcome.worst_window_j = outcome.worst_window_j.max(out - lowest);
            outcome.above_refill_j = outcome.above_refill_j.max(out - refilled - lowest_above);
        }
        acting = new;
        outcome.ticks += 1;
    }
    outcome.last_account_j = account(&felt);
    outcome
}

/// How a hostile profile's points are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Hostile {
    /// Points at random.
    Random,
    /// Runs of points at one limit and at the other in turn, with cliffs in between. A single run has no cliff.
    Cliffs,
    /// A ramp that drives the knob in one direction, and falls back within a step.
    Saw,
    /// One torque in one direction everywhere.
    Drive,
}

impl Hostile {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Random, Self::Cliffs, Self::Saw, Self::Drive];

    /// A profile of this kind. It has up to 200 copies per turn, or exists once around the hand's start.
    ///
    /// # Panics
    /// Never.
    #[must_use]
    pub fn profile(self, seed: u64) -> ProfileSettings {
        let mut random = Random::new(40_000 + seed);
        let n = 2 + random.bits() as usize % (MOST_POINTS - 1);
        let whole = i32::from(WHOLE);
        let every = 1 + random.bits() as usize % n;
        let points: Vec<i16> = (0..n)
            .map(|i| match self {
                Self::Random => random.whole(whole) as i16,
                Self::Cliffs if (i / every).is_multiple_of(2) => WHOLE,
                Self::Cliffs => -WHOLE,
                Self::Saw => (2 * whole * i as i32 / (n as i32 - 1) - whole) as i16,
                Self::Drive => WHOLE,
            })
            .collect();
        ProfileSettings {
            extent: match seed % 3 {
                0 => Extent::Until(Si::lit("0.05")),
                1 => Extent::PerTurn(1 + (random.bits() % 200) as u16),
                _ => Extent::PerTurn(1),
            },
            start: Si::lit("-0.05"),
            strength: Si::from_num(STRENGTH_N_M),
            shape: Shape::new(&points).unwrap(),
        }
    }
}
