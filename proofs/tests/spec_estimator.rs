//! Tests that the shipped estimator and its specification give the same results and memory bit for bit, over millions of ticks,
//! with estimators from settings of every size. Also compares their coefficients with closed forms, which the code does not use.
//! These are samples, not proofs.

use fixed::types::I8F24;
use touchstone_control::estimator::{EstimatorState, Flow};
use touchstone_control::{Estimator, EstimatorSettings, Fixed32, Force, Position, Si};
use touchstone_proofs::estimated::{memory, specified};
use touchstone_proofs::spec::hands::Random;

const TICKS: u64 = 2_000_000;

/// Random settings of the estimator, control rate and force limit; not all are accepted.
fn any_settings(random: &mut Random) -> (EstimatorSettings, u32, Si) {
    let rate: u32 = [100, 1000, 2000, 4000, 10_000, 20_000][random.below(6) as usize];
    let share = |random: &mut Random, most: u64| {
        Si::from_num(random.below(1 << 20)) / (1 << 20) * Si::from_num(most)
    };
    let (heaviest, slowest) = (
        60_000_000 >> random.below(26),
        u64::from(rate) >> random.below(12),
    );
    let per_tick2 = Si::from_num(1 + random.below(heaviest));
    let inertia = (per_tick2 + share(random, 1)) / i64::from(rate) / i64::from(rate);
    let settings = EstimatorSettings {
        bandwidth_hz: Si::from_num(rate) / 5 - share(random, u64::from(rate / 5)),
        inertia,
        damping: inertia * share(random, slowest),
        delay_s: share(random, 3) / i64::from(rate),
    };
    (settings, rate, share(random, 16))
}

fn state(of: i128) -> i64 {
    i64::try_from(of).expect("a state")
}

#[test]
fn every_tick_of_the_estimator_is_its_specification() {
    let mut random = Random(7);
    let (mut ticks, mut made, mut reached) = (0, 0, [0_u64; 5]);
    while ticks < TICKS {
        let (settings, rate, limit) = any_settings(&mut random);
        let Ok(law) = settings.estimator::<Fixed32>(rate, limit) else {
            continue;
        };
        made += 1;
        let spec = specified(&law);
        let mut before = EstimatorState::<Fixed32>::default();
        let (mut e, mut moved) = (0_i64, 0_i64);
        for _ in 0..500 {
            ticks += 1;
            // The hand moves at any speed and sometimes jumps.
            if random.below(8) == 0 {
                moved = random.signed(26);
            }
            e += moved;
            if random.below(64) == 0 {
                e = random.signed(31);
            }
            e = e.clamp(i32::MIN.into(), i32::MAX.into());
            let measured = Position(I8F24::from_bits(e as i32));
            let mut after = before;
            let sample = law.tick(&mut after, measured);
            let (expected, at, step) = spec.tick(&memory(&before), e.into());
            let got = [sample.e, sample.moved].map(|x| i128::from(x.0.to_bits()));
            assert_eq!(memory(&after), expected, "{settings:?} {before:?} {e}");
            assert_eq!(got, [at, step], "{settings:?} {before:?} {e}");
            let force: Force<Fixed32> = Force(I8F24::from_bits(random.signed(31) as i32));
            let expected = spec.commanded(&expected, i128::from(force.0.to_bits()));
            law.commanded(&mut after, force);
            assert_eq!(memory(&after), expected);
            let motion = expected.motion.expect("after a tick");
            let anew = motion.d == 0 && motion.g == 0 && state(motion.x) == e << 30;
            let now = [
                anew,
                !anew && motion.d > 0,
                force.0.to_bits() < -law.limit.0.to_bits(),
                at != i128::from(e),
                at == (1 << 31) - 1,
            ];
            for (count, now) in reached.iter_mut().zip(now) {
                *count += u64::from(now);
            }
            before = after;
        }
    }
    println!("{ticks} ticks of {made} estimators, {reached:?}");
    assert!(reached.iter().all(|count| *count > 50), "{reached:?}");
}

/// How far a device moves in a time by a displacement per tick (`V`) and by a push (`X`), in closed form. `loss` is the fraction of
/// the velocity that damping takes per tick. If `loss` times the time is below 1/64, the first terms of the series are used
/// instead; the next term is less than `2^-50`.
fn integrals(loss: f64, time: f64) -> [f64; 2] {
    let a = loss * time;
    if a < 1.0 / 64.0 {
        let sum = |first: f64| {
            let (mut term, mut sum) = (1.0, 0.0);
            for k in 0..8 {
                sum += term;
                term *= -a / (first + f64::from(k));
            }
            sum
        };
        return [time * sum(2.0), time * time / 2.0 * sum(3.0)];
    }
    let reach = -(-a).exp_m1() / loss;
    [reach, (time - reach) / loss]
}

/// Asserts that coefficients are the closed form rounded to the nearest step. A hundredth of a step is allowed for rounding in the
/// closed form.
fn near(
    weights: &[i32],
    fraction: i32,
    expected: &[f64],
    steps: f64,
    settings: &EstimatorSettings,
) {
    for (weight, expected) in weights.iter().zip(expected) {
        let away = (f64::from(*weight) - expected * f64::from(fraction).exp2()).abs();
        assert!(away <= steps, "{weights:?} {expected} {away} {settings:?}");
    }
}

/// Coefficients of a device's prediction over `time` in closed form; each command ends the given number of ticks before the
/// prediction's end.
fn of_device<const C: usize>(
    flow: &Flow<Fixed32, C>,
    [loss, per_torque]: [f64; 2],
    time: f64,
    end: impl Fn(f64) -> f64,
    settings: &EstimatorSettings,
) {
    let [reach, drift] = integrals(loss, time);
    let weights = [flow.reach, flow.drift, flow.loss];
    near(&weights, 26, &[reach, drift, loss * reach], 0.51, settings);
    for (i, weights) in flow.commands.iter().enumerate() {
        let at = |t: f64| integrals(loss, t.clamp(0.0, time));
        let ends = end(i as f64);
        let ([reach, drift], [later, less]) = (at(ends + 1.0), at(ends));
        let taken = [drift - less, reach - later].map(|x| x * per_torque);
        near(weights, 30, &taken, 0.51, settings);
    }
}

#[test]
fn coefficients_are_the_closed_forms_to_the_nearest_step() {
    let mut random = Random(8);
    let (mut made, mut refused, mut reached) = (0, 0, [0_u64; 5]);
    while made < 20_000 {
        let (settings, rate, limit) = any_settings(&mut random);
        let Ok(law) = settings.estimator::<Fixed32>(rate, limit) else {
            refused += 1;
            continue;
        };
        made += 1;
        let Estimator {
            tick,
            ahead,
            correction,
            limit: stored,
        } = &law;
        assert_eq!(i64::from(stored.0.to_bits()), limit.to_bits() >> 8);
        let number = |si: Si| si.to_num::<f64>();
        let rate = f64::from(rate);
        let angle = std::f64::consts::TAU * number(settings.bandwidth_hz) / rate;
        let inertia = number(settings.inertia) * rate * rate;
        let asked = number(settings.damping) * rate / inertia;
        let loss = asked.min(angle);
        let delay = (number(settings.delay_s) * rate).min(2.0);
        let device = [loss, 1.0 / inertia];
        of_device(tick, device, 1.0, |i| i - delay, &settings);
        of_device(ahead, device, delay, |i| i, &settings);
        let [reach, drift] = integrals(loss, 1.0);
        let (pole, kept) = ((-angle).exp(), (-loss).exp());
        let alpha = 1.0 - pole.powi(3) / kept;
        let gamma = (1.0 - pole).powi(3) / reach;
        let beta = (2.0 + kept - 3.0 * pole - alpha - drift * gamma) / reach;
        near(correction, 26, &[alpha, beta, gamma], 0.51, &settings);
        let now = [
            asked > angle,
            loss == 0.0,
            loss * 64.0 > 1.0,
            delay == 2.0,
            delay < 0.5,
        ];
        for (count, now) in reached.iter_mut().zip(now) {
            *count += u64::from(now);
        }
    }
    println!("{made} estimators, {refused} refused, {reached:?}");
    assert!(
        refused > 50 && reached.iter().all(|count| *count > 50),
        "{reached:?}"
    );
}
