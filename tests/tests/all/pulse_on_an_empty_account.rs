//! Tests that the pulse and the vibration at the touch (`law.impact`) get nothing from an empty energy account: the hand gets out
//! at most the guard's refill, and neither another touch nor arming adds energy to the account.

use touchstone_control::{Controller, Energy, Fixed32, Position, Reported, Settings, Si};
use touchstone_tests::si::si;

/// Largest speed of the hand, rad per control period.
const STEP_RAD: f64 = 0.004;
/// Control periods between two touches, long enough outside the wall for the next entry to be a new touch.
const PERIOD: u32 = 80;
const TOUCHES: u32 = 60;

/// The shipped wall with a strong pulse and a long vibration.
fn settings() -> Settings {
    let mut settings = Settings {
        k_desired: si("14"),
        ..Settings::default()
    };
    settings.impact.momentum = si("2");
    settings.impact.vibration = si("1");
    settings.impact.decay_s = si("0.05");
    settings
}

/// A hand that goes into the wall at full speed, turns back at a penetration, and leaves at full speed. In between it may swing in
/// time with the vibration.
#[derive(Debug, Clone, Copy)]
struct Motion {
    /// Penetration at which the hand turns back, in steps of `STEP_RAD`.
    turn: f64,
    /// Control periods for which the hand swings before it leaves.
    swings: u32,
    /// Phase of the swing at its start, as a share of a full turn.
    phase: f64,
}

impl Motion {
    /// Penetration in a control period of a touch, rad.
    fn at(&self, tick: u32) -> f64 {
        const INWARD: u32 = 10;
        let steps = f64::from(tick.min(INWARD)) - f64::from(INWARD);
        let swing_s = 0.001 * f64::from(tick.clamp(INWARD, INWARD + self.swings) - INWARD);
        let turns = 100.0 * swing_s;
        let wave = |turns: f64| (std::f64::consts::TAU * (turns + self.phase)).sin();
        let swing = wave(turns) - wave(0.0);
        let out = f64::from(tick.saturating_sub(INWARD + self.swings)).min(20.0);
        STEP_RAD * (self.turn + steps + swing - out)
    }
}

fn motions() -> Vec<Motion> {
    let mut all = Vec::new();
    for turn in [-1.0, -0.5, 0.05, 0.5, 1.0, 2.0, 3.0] {
        for swings in [0, 40] {
            for phase in [0.0, 0.25, 0.5, 0.75] {
                all.push(Motion {
                    turn,
                    swings,
                    phase,
                });
            }
        }
    }
    all
}

/// What a hand gets out in all touches.
#[derive(Debug, Clone, Copy, Default)]
struct Taken {
    /// Largest energy since the start beyond the guard's refill since then, J.
    above_refill_j: f64,
    /// Control periods in which the guard reduced the force.
    limited: u32,
}

/// Touches the wall again and again. The account starts with `account_j`; `None` runs the wall without a guard. With `arms` the
/// force is switched off and on between two touches.
fn taken(motion: Motion, account_j: Option<f64>, arms: bool) -> Taken {
    let mut settings = settings();
    settings.guard.on = account_j.is_some();
    let fresh = Controller::<Fixed32>::new(&settings).unwrap();
    let mut wall = fresh;
    if let (Some(guard), Some(start)) = (&mut wall.guard, account_j) {
        guard.state.account = Energy::from_si(Si::from_num(start)).unwrap();
    }
    let to_f64 = |value: Si| value.to_num::<f64>();
    let damping = to_f64(settings.guard.damping) * to_f64(settings.guard.share_of_damping);
    let tick_s = 1.0 / f64::from(settings.rate_hz);
    let refill_j = to_f64(settings.guard.refill) * tick_s;
    let (mut energy_j, mut force, mut before) = (0.0, 0.0, None);
    let mut found = Taken::default();
    for tick in 0..TOUCHES * PERIOD {
        if arms && tick % PERIOD == 0 {
            let level = |wall: &Controller<Fixed32>| wall.guard.map(|guard| guard.account());
            wall.switched_off();
            force = 0.0;
            let left = level(&wall);
            wall.resume(&fresh);
            assert_eq!(level(&wall), left, "arming changes the account");
        }
        let e = Position::<Fixed32>(Fixed32::signal_from_f64(motion.at(tick % PERIOD)));
        let moved = before.map_or(0.0, |before| e.to_f64() - before);
        before = Some(e.to_f64());
        energy_j -= force * moved + damping * moved * moved / tick_s;
        let refilled_j = refill_j * f64::from(tick);
        found.above_refill_j = found.above_refill_j.max(energy_j - refilled_j);
        force = wall.tick(e).to_f64();
        found.limited += u32::from(wall.guard.is_some_and(|guard| guard.limited));
        assert!(!wall.tripped(), "{motion:?}: the hand is too fast");
    }
    found
}

/// The most that any hand takes out above the refill, J, and the most control periods in which the guard reduced the force.
fn worst(account_j: Option<f64>, arms: bool) -> Taken {
    let all = motions().into_iter().map(|it| taken(it, account_j, arms));
    all.fold(Taken::default(), |worst, it| Taken {
        above_refill_j: worst.above_refill_j.max(it.above_refill_j),
        limited: worst.limited.max(it.limited),
    })
}

/// What the hands take out without a guard, and with one that begins with a full and with an empty account. Checks that the guard
/// keeps its promise, and returns the first two.
fn checked(arms: bool) -> [f64; 2] {
    let settings = settings();
    let capacity_j: f64 = settings.guard.capacity.to_num();
    // Energy of half an encoder count at each end of the time, under the largest force.
    let count_j =
        settings.force_limit.to_num::<f64>() * settings.guarded_device().count.to_num::<f64>();
    let [bare, full, empty] =
        [None, Some(capacity_j), Some(0.0)].map(|account| worst(account, arms));
    println!(
        "arms: {arms}. Above the refill: {:.2} mJ without a guard, {:.2} with a full account, {:.4} with an empty one; allowed {:.4}",
        1e3 * bare.above_refill_j,
        1e3 * full.above_refill_j,
        1e3 * empty.above_refill_j,
        1e3 * count_j
    );
    assert!(empty.above_refill_j <= count_j, "{empty:?}");
    assert!(full.above_refill_j <= capacity_j + count_j, "{full:?}");
    assert!(empty.limited > TOUCHES, "{empty:?}");
    [bare, full].map(|taken| taken.above_refill_j / capacity_j)
}

#[test]
fn an_empty_account_pays_for_no_pulse() {
    let [bare, full] = checked(false);
    // The hands do find the pulse's energy.
    assert!(
        bare > 1.5 && full > 0.5,
        "{bare} and {full} of the capacity"
    );
}

#[test]
fn arming_between_touches_adds_nothing_to_the_account() {
    let [bare, _] = checked(true);
    assert!(bare > 1.5, "{bare} of the capacity");
}

/// Checks a touch with an empty account against the same touch with a full one: the pulse's force is missing.
#[test]
fn the_first_force_of_a_touch_is_what_the_account_pays_for() {
    let motion = Motion {
        turn: 0.5,
        swings: 0,
        phase: 0.0,
    };
    let largest = |account: &str| {
        let mut wall = Controller::<Fixed32>::new(&settings()).unwrap();
        if let Some(guard) = &mut wall.guard {
            guard.state.account = Energy::from_si(si(account)).unwrap();
        }
        let forces = (0..PERIOD).map(|tick| {
            let e = Position::<Fixed32>(Fixed32::signal_from_f64(motion.at(tick)));
            let force = wall.tick(e).to_f64();
            // The account must not go below 0 by a force that the law adds at the touch.
            assert!(wall.guard.unwrap().account() >= Energy::zero(), "{tick}");
            force
        });
        forces.fold(0.0_f64, f64::max)
    };
    let (full, empty) = (largest("0.045"), largest("0"));
    println!("largest force: {full:.3} N·m with a full account, {empty:.4} with an empty one");
    assert!(full > 0.4 && empty < 0.05 * full, "{full} {empty}");
}
