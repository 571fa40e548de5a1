//! Tests of an environment (walls and detents) that is replaced while a hand touches it: the force changes no faster than the
//! stated rate, and the energy account keeps its level.

use touchstone_control::environment::{DetentSettings, Environment, Side, WallSettings};
use touchstone_control::{Controller, Fixed32, Force, LawKind, Position, Settings, Si, StatesKind};
use touchstone_tests::environment::{at, encoder, wall};
use touchstone_tests::random::Random;
use touchstone_tests::si::si;

const RATE_HZ: u32 = 1_000;
/// Rate in N·m/s at which the force difference fades after walls or detents were replaced.
const RATE: &str = "0.5";

fn settings(law: LawKind, states: StatesKind) -> Settings {
    let mut settings = Settings {
        law,
        states,
        rate_hz: RATE_HZ,
        ..Settings::thesis()
    };
    settings.guard.on = true;
    settings
}

fn laws() -> impl Iterator<Item = Settings> {
    <LawKind as touchstone_control::Choice>::ALL
        .iter()
        .flat_map(|law| {
            [StatesKind::Measured, StatesKind::Estimated].map(|states| settings(*law, states))
        })
}

/// Environments (sets of walls and detents) that the tests replace by one another: empty, walls near and far and on either side,
/// detents.
fn environments(settings: &Settings) -> Vec<Environment<Fixed32>> {
    let near = wall("0.05", Side::Above);
    let below = wall("0.09", Side::Below);
    let deep = wall("0.01", Side::Above);
    let detents = DetentSettings::around_a_turn(24, si("0.1"), si("0.03"));
    let built = |walls: &[WallSettings], detents: Option<&DetentSettings>| {
        Environment::new(settings, walls, detents).unwrap_or_else(|error| panic!("{error}"))
    };
    vec![
        built(&[], None),
        built(&[near], None),
        built(&[near, below], Some(&detents)),
        built(&[deep], None),
        built(&[below], None),
        built(&[], Some(&detents)),
        built(&[near, deep], None),
    ]
}

fn per_tick() -> Force<Fixed32> {
    Environment::<Fixed32>::change_per_tick(si(RATE), RATE_HZ)
}

fn newton_metres(force: Force<Fixed32>) -> f64 {
    force.0.to_num()
}

/// Checks that replacing an environment (walls and detents) adds the difference of forces in the first control period, and lets it
/// fade at the rate. The force is compared with that of the new environment alone. Both run without an energy guard, which would
/// react to the added force.
#[test]
fn a_change_adds_what_is_let_go_of_and_nothing_else() {
    let mut random = Random::new(7);
    let (mut changes, mut compared, mut at_limit) = (0, 0_u32, 0_u32);
    for mut settings in laws() {
        // Without a guard: the accounts of the two compared environments would differ, and a guard could reduce one of the
        // forces.
        settings.guard.on = false;
        // At the force limit the added force could not be seen.
        settings.force_limit = si("20");
        let all = environments(&settings);
        for before in &all {
            for after in &all {
                let mut running = *before;
                running.begin(None);
                let mut count = 200_i64;
                let mut shown = Force::zero();
                for _ in 0..300 {
                    count += i64::from(random.whole(4)) + 1;
                    shown = running.tick(&at(count), None);
                }
                let mut new = *after;
                new.begin(None);
                new.take_over(&running, per_tick());
                // `own` calculates the force of the new environment alone. It gets the rendered force reported, because that
                // force moves the device.
                let mut own = new;
                own.take_over(&running, Force(fixed::types::I8F24::MAX));
                let mut left = f64::INFINITY;
                for n in 0..400 {
                    count += i64::from(random.whole(4));
                    let (f, g) = (new.tick(&at(count), None), own.tick(&at(count), None));
                    own.commanded(f);
                    if n == 0 {
                        assert_eq!(f, shown, "the first tick shows what the last one showed");
                        continue;
                    }
                    // At the limit no larger force can be rendered.
                    if newton_metres(f).abs() >= 19.999 || newton_metres(g).abs() >= 19.999 {
                        at_limit += 1;
                        left = f64::INFINITY;
                        continue;
                    }
                    compared += 1;
                    let carried = newton_metres(f) - newton_metres(g);
                    assert!(
                        carried.abs() <= left + 1e-6,
                        "{:?} {n}: {carried} after {left}",
                        settings.law
                    );
                    if left.is_finite() {
                        let step = newton_metres(per_tick()) + 1e-6;
                        assert!(
                            (left - carried.abs()) <= step,
                            "{n}: {carried} after {left}"
                        );
                    }
                    left = carried.abs();
                }
                changes += 1;
            }
        }
    }
    assert!(
        changes > 500 && at_limit < compared / 50,
        "{changes} {compared} {at_limit}"
    );
}

/// Checks that a hand at rest feels no faster change of force than the rate, whatever wall or detent appears or disappears. The
/// control law is a spring, because other laws also change the force themselves.
#[test]
fn a_hand_that_rests_feels_the_rate_and_no_more() {
    let settings = settings(LawKind::Spring, StatesKind::Measured);
    let all = environments(&settings);
    let mut largest = 0.0_f64;
    let mut reached = 0;
    for before in &all {
        for after in &all {
            let mut running = *before;
            running.begin(None);
            let mut count = 300;
            while count < 480 {
                count += 1;
                running.tick(&at(count), None);
            }
            let mut shown = running.tick(&at(count), None);
            let mut new = *after;
            new.begin(None);
            new.take_over(&running, per_tick());
            for _ in 0..4_000 {
                let force = new.tick(&at(count), None);
                largest = largest.max((newton_metres(force) - newton_metres(shown)).abs());
                shown = force;
            }
            assert!(!new.is_changing());
            let mut fresh = *after;
            fresh.begin(None);
            reached += u32::from(fresh.tick(&at(count), None) == shown);
        }
    }
    let rate = largest * f64::from(RATE_HZ);
    assert!((0.49..=0.501).contains(&rate), "{rate} N·m/s");
    assert_eq!(reached as usize, all.len() * all.len());
}

/// Checks the change from a single wall to an environment (several walls and detents). The forces are the same as for the change
/// from an environment with only that wall.
#[test]
fn a_wall_alone_hands_over_as_an_environment_of_it_does() {
    let (mut touched, mut yielded) = (0, 0);
    for mut settings in laws() {
        // Both guards round the motion differently. With an account that covers everything, that changes no force.
        settings.guard.capacity = si("8");
        settings.guard.overspeed = si("900");
        let first = wall("0.05", Side::Above);
        let all = environments(&settings);
        for after in &all {
            let mut alone = Controller::<Fixed32>::new(&settings).unwrap();
            let mut around = all[1];
            around.begin(None);
            let scale = encoder().before(si("0.05"));
            let mut random = Random::new(3);
            let (mut count, mut shown) = (280_i64, Force::zero());
            for _ in 0..200 {
                count += i64::from(random.whole(5)) + 1;
                shown = alone.tick(scale.penetration(count));
                assert_eq!(around.tick(&at(count), None), shown);
            }
            touched += u32::from(shown > Force::zero());
            // A deep press, in which the surface of most laws gives way.
            for _ in 0..1_500 {
                count += 2;
                shown = alone.tick(scale.penetration(count));
                assert_eq!(around.tick(&at(count), None), shown);
            }
            yielded += u32::from(alone.surface.given > Position::zero());
            let (mut one, mut other) = (*after, *after);
            one.take_over_from(&alone, &first, (&at(count), shown), per_tick());
            other.take_over(&around, per_tick());
            for _ in 0..400 {
                count += i64::from(random.whole(5)) - 4;
                assert_eq!(one.tick(&at(count), None), other.tick(&at(count), None));
            }
        }
    }
    assert!(touched > 40, "{touched}");
    assert!(yielded > 20, "{yielded}");
}

/// Checks that one energy account bounds what a hand gets out when walls appear under it again and again.
#[test]
fn many_changes_have_one_account() {
    let mut settings = settings(LawKind::Spring, StatesKind::Measured);
    let capacity = "0.02";
    settings.guard.capacity = si(capacity);
    settings.guard.refill = Si::ZERO;
    settings.guard.damping = Si::ZERO;
    let all = environments(&settings);
    let mut worst = 0.0_f64;
    let mut limited = 0_u32;
    let fast = Environment::change_per_tick(si("10"), RATE_HZ);
    for seed in 1..40 {
        let mut random = Random::new(seed);
        let mut running = all[0];
        running.begin(None);
        let mut count = 400_i64;
        let (mut given, mut before, mut force) = (0.0, count, Force::zero());
        let mut least = 0.0_f64;
        for n in 0..12_000 {
            if n % 300 == 0 {
                let mut new = all[random.bits() as usize % all.len()];
                new.begin(None);
                new.take_over(&running, fast);
                running = new;
            }
            // The hand yields in the direction of the force, which gives it the most energy.
            let push = newton_metres(force);
            count -= (push * 60.0) as i64;
            // The hand comes back while nothing pushes it.
            if push.abs() < 0.01 {
                count += (400 - count).clamp(-3, 3);
            }
            given -= push * (count - before) as f64 * std::f64::consts::TAU / 40_000.0;
            before = count;
            force = running.tick(&at(count), None);
            limited += u32::from(running.guard.as_ref().is_some_and(|guard| guard.limited));
            least = least.min(given);
            worst = worst.max(given - least);
        }
    }
    // The last tick's force still acts.
    assert!(worst <= 0.02 + 1e-4, "{worst} J");
    assert!(
        worst > 0.01 && limited > 100,
        "{worst} J, limited {limited}"
    );
}

/// Checks that a wall that appears around a moving hand gives it no pulse at the touch: the forces are those of the same wall
/// without a pulse. The estimator of a new wall starts at rest, and the hand has to leave the wall before its next touch.
#[test]
fn a_wall_that_appears_around_a_moving_hand_gives_no_pulse() {
    let mut without = Settings::default();
    without.guard.on = false;
    without.impact.momentum = Si::ZERO;
    let mut with = without;
    with.impact.momentum = si("2");
    let forces = |settings: &Settings| {
        let all = environments(settings);
        let mut running = all[0];
        running.begin(None);
        // 2.4 rad/s, past the surface at 0.05 rad.
        let mut count = 0;
        let mut step = |environment: &mut Environment<Fixed32>| {
            count += 15;
            environment.tick(&at(count), None)
        };
        (0..40).for_each(|_| assert_eq!(step(&mut running), Force::zero()));
        let mut new = all[1];
        new.begin(None);
        new.take_over(&running, per_tick());
        (0..30).map(|_| step(&mut new)).collect::<Vec<_>>()
    };
    assert_eq!(forces(&with), forces(&without));
    assert!(forces(&with).iter().any(|force| *force > Force::zero()));
}
