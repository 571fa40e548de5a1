//! Compares velocity filters in every number format with closed forms: ramps, noise, the Riccati equation, and the adaptive window
//! as its authors published it.

use touchstone_control::velocity::{LONGEST_WINDOW, Velocity, VelocityState};
use touchstone_control::{
    AnyLaw, Choice as _, Controller, Field, Fixed16, Fixed32, LawKind, Position, Reported,
    Settings, SettingsError, Si, StatesKind, VelocityKind, VelocitySettings,
};
use touchstone_tests::random::Random;
use touchstone_tests::si::si;

const RATE_HZ: u32 = 1000;
const COUNT: f64 = std::f64::consts::TAU / 40_000.0;
const OWN: [VelocityKind; 4] = [
    VelocityKind::Filtered,
    VelocityKind::Foaw,
    VelocityKind::Kalman,
    VelocityKind::KalmanAcceleration,
];

fn velocity<N: Reported>(from: VelocityKind, count: f64) -> Velocity<N> {
    let settings = VelocitySettings {
        from,
        ..VelocitySettings::default()
    };
    settings
        .velocity(RATE_HZ, Si::from_num(count))
        .unwrap()
        .expect("a filter of its own")
}

/// Velocities (displacements per control period) that a filter calculates along a path of positions.
fn over<N: Reported>(from: VelocityKind, count: f64, path: impl Iterator<Item = f64>) -> Vec<f64> {
    let (filter, mut state) = (velocity::<N>(from, count), VelocityState::default());
    path.map(|x| filter.tick(&mut state, Position::from_f64(x)).to_f64())
        .collect()
}

/// Steady gains of a Kalman filter of 2nd or 3rd order, from iterating the Riccati equation. `lambda` is the size of the white
/// process noise relative to the measurement noise.
fn riccati(order: usize, lambda: f64) -> [f64; 3] {
    let free = [[1.0, 1.0, 0.5], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]];
    let driven = [0.5, 1.0, if order == 3 { 1.0 } else { 0.0 }];
    let mut p = [[0.0; 3]; 3];
    let mut gains = [0.0; 3];
    for _ in 0..50_000 {
        let mut next = [[0.0; 3]; 3];
        for i in 0..order {
            for j in 0..order {
                for k in 0..order {
                    for l in 0..order {
                        next[i][j] += free[i][k] * p[k][l] * free[j][l];
                    }
                }
                next[i][j] += lambda * lambda * driven[i] * driven[j];
            }
        }
        let seen = next[0][0] + 1.0;
        for i in 0..order {
            gains[i] = next[i][0] / seen;
            for j in 0..order {
                p[i][j] = next[i][j] - next[i][0] / seen * next[0][j];
            }
        }
    }
    gains
}

#[test]
fn the_gains_solve_the_riccati_equation() {
    let p = 30.0 / f64::from(RATE_HZ);
    for (from, order, r) in [
        (
            VelocityKind::Kalman,
            2,
            (-std::f64::consts::SQRT_2 * std::f64::consts::PI * p).exp(),
        ),
        (
            VelocityKind::KalmanAcceleration,
            3,
            (-std::f64::consts::TAU * p).exp(),
        ),
    ] {
        let Velocity::Tracker(tracker) = velocity::<f64>(from, COUNT) else {
            panic!("{from:?} is a tracker");
        };
        let [alpha, beta, gamma] = tracker.correction;
        assert!((alpha - (1.0 - r * r)).abs() < 1e-12, "{from:?}: {alpha}");
        let last = if order == 2 { beta } else { gamma };
        let solved = riccati(order, last / (1.0 - alpha).sqrt());
        for (ours, theirs) in tracker.correction.into_iter().zip(solved) {
            assert!((ours - theirs).abs() < 1e-10, "{from:?}: {ours} {theirs}");
        }
    }
}

#[test]
fn a_ramp_is_followed_at_its_own_speed() {
    fn body<N: Reported>(slack: f64) {
        for from in OWN {
            for speed in [3e-3, -3e-3] {
                let path = (0..400).map(|n| speed * f64::from(n));
                let last = *over::<N>(from, 0.0, path).last().unwrap();
                assert!((last - speed).abs() <= slack, "{from:?} {speed}: {last}");
            }
        }
    }
    // 400 ticks are 12 periods of the filters' bandwidth of 30 Hz. The last bits depend on the format: its quantum, and for a
    // window the rounding of 1/15 times the displacement.
    body::<f64>(1e-9);
    body::<Fixed32>(2.0 * 2f64.powi(-24));
    body::<Fixed16>(2.0 * 2f64.powi(-14));
}

#[test]
fn of_white_noise_remains_what_the_closed_form_says() {
    let mut random = Random::new(11);
    let ticks = 400_000;
    let noise: Vec<f64> = (0..ticks).map(|_| 1e-4 * random.real()).collect();
    let variance = 1e-8 / 3.0;
    let angle = std::f64::consts::TAU * 30.0 / f64::from(RATE_HZ);
    let a = 1.0 - (-angle).exp();
    let r = (-angle / std::f64::consts::SQRT_2).exp();
    let (alpha, beta) = (1.0 - r * r, 2.0 * (1.0 - r) * (1.0 - r));
    for (from, expected) in [
        (VelocityKind::Filtered, 2.0 * a * a / (2.0 - a)),
        (
            VelocityKind::Kalman,
            2.0 * beta * beta / (alpha * (4.0 - 2.0 * alpha - beta)),
        ),
    ] {
        let shown = over::<f64>(from, 0.0, noise.iter().copied());
        let seen = shown[2_000..].iter().map(|v| v * v).sum::<f64>() / f64::from(ticks - 2_000);
        let ratio = seen / (expected * variance);
        println!("{from:?}: {ratio:.4} of what is expected");
        // Neighbouring values are correlated over some 5 to 10 ticks. So there are 40,000 independent values, which give a variance
        // to 0.7 %; three times that is allowed.
        assert!((ratio - 1.0).abs() < 0.021, "{from:?}: {ratio}");
    }
}

/// The adaptive window as its paper defines it: it grows while every position in between lies within `d` of the line through the
/// window's two ends. Returns the displacement over the best window, and the window's length.
fn window_as_published(past: &[i64], d: i64, longest: usize) -> (i64, i64) {
    let now = past[past.len() - 1];
    let at = |back: usize| {
        past.len()
            .checked_sub(1 + back)
            .map_or(past[0], |i| past[i])
    };
    let mut best = (0, 1);
    for n in 1..=longest {
        let way = now - at(n);
        let fits = (1..n).all(|i| {
            let off = n as i64 * (now - at(i)) - i as i64 * way;
            off.abs() <= n as i64 * d
        });
        if !fits {
            break;
        }
        best = (way, n as i64);
    }
    best
}

#[test]
fn the_adaptive_window_is_the_published_one() {
    let (unit, d) = (2f64.powi(-12), 3);
    // The filter adds three quanta of the format to its margin, of which 2.5 are subtracted here. The remaining half changes
    // nothing for positions in whole units.
    let margin = d as f64 * unit - 2.5 * 2f64.powi(-24);
    let filter = velocity::<Fixed32>(VelocityKind::Foaw, margin);
    let mut state = VelocityState::default();
    let mut random = Random::new(5);
    let (mut at, mut speed) = (0_i64, 0_i64);
    let mut past = Vec::new();
    let mut lengths = [0_u32; LONGEST_WINDOW + 1];
    for _ in 0..20_000 {
        if random.bits().is_multiple_of(24) {
            speed = i64::from(random.whole(8));
        }
        at = (at + speed + i64::from(random.whole(2))).clamp(-200_000, 200_000);
        past.push(at);
        let shown = filter.tick(&mut state, Position::from_f64(at as f64 * unit));
        let (way, n) = window_as_published(&past, d, 15);
        lengths[n as usize] += 1;
        let expected = way as f64 * unit / n as f64;
        // The ratio 1/n is right to one quantum, times the displacement.
        let slack = 2f64.powi(-24) * (2.0 + (way as f64 * unit).abs());
        assert!(
            (shown.to_f64() - expected).abs() <= slack,
            "{} for {expected}",
            shown.to_f64()
        );
    }
    println!("windows of 0 to 16 ticks: {lengths:?}");
    assert!(lengths[1] > 100 && lengths[15] > 100, "{lengths:?}");
}

#[test]
fn a_slow_ramp_of_counts_is_quieter_than_its_difference() {
    // One count in about 7 ticks.
    let counted = |n: u32| (0.021_7 * f64::from(n) * 1e-3 / COUNT).floor() * COUNT;
    let speed = 0.021_7e-3;
    let spread = |shown: &[f64]| {
        let off = |v: &f64| (v - speed) * (v - speed);
        (shown[1_000..].iter().map(off).sum::<f64>() / 4_000.0).sqrt()
    };
    let path: Vec<f64> = (0..5_000).map(counted).collect();
    let difference: Vec<f64> = std::iter::once(0.0)
        .chain(path.windows(2).map(|pair| pair[1] - pair[0]))
        .collect();
    let of_difference = spread(&difference);
    for from in OWN {
        let ours = spread(&over::<f64>(from, COUNT, path.iter().copied()));
        println!("{from:?}: {:.1} times quieter", of_difference / ours);
        assert!(
            ours < 0.4 * of_difference,
            "{from:?}: {ours} {of_difference}"
        );
    }
}

/// Bound of the rounding error of a filter's velocity in fixed point. A product is cut at 2^-28, rounding a coefficient costs
/// 2^-27, and each error persists for as long as the filter remembers.
fn rounding(from: VelocityKind, surprise: f64) -> f64 {
    let (cut, half_step) = (2f64.powi(-28), 2f64.powi(-27));
    let gains = match velocity::<f64>(from, COUNT) {
        Velocity::Tracker(tracker) => tracker.correction,
        // The position is measured, so it has no error. An error of the velocity decays by the filter's fraction per tick.
        Velocity::Smoothed(filter) => return (cut + half_step * surprise) / filter.share,
        Velocity::Window(_) => panic!("a window has no memory of states"),
    };
    let into = [1.5, 1.0, 0.0];
    (0..3)
        .map(|disturbed| {
            let mut state = [0.0; 3];
            state[disturbed] = 1.0;
            let mut lives_on = 0.0;
            for _ in 0..1_000 {
                lives_on += f64::abs(state[1]);
                let [x, v, g] = state;
                let expected = [x + v + 0.5 * g, v + g, g];
                state = [0, 1, 2].map(|i| expected[i] - gains[i] * expected[0]);
            }
            // The error acts before the correction, or is the correction's own; both are at most this.
            lives_on * (into[disturbed] * cut + gains[disturbed] * cut + half_step * surprise)
        })
        .sum()
}

#[test]
fn fixed_point_says_what_f64_says() {
    let mut random = Random::new(7);
    let mut x = 0.0_f64;
    let path: Vec<f64> = (0..20_000)
        .map(|n| {
            x = (x + 2e-3 * random.real() + 1e-3 * (f64::from(n) / 200.0).sin()).clamp(-1.5, 1.5);
            // On the grid of the narrowest format, so that all formats get the same positions.
            (x * 16_384.0).floor() / 16_384.0
        })
        .collect();
    for from in [
        VelocityKind::Filtered,
        VelocityKind::Kalman,
        VelocityKind::KalmanAcceleration,
    ] {
        let exact = over::<f64>(from, COUNT, path.iter().copied());
        let far = |other: Vec<f64>| {
            let off = exact.iter().zip(other).map(|(a, b)| (a - b).abs());
            off.fold(0.0, f64::max)
        };
        // An innovation (measured minus predicted position) is at most the change of position and speed: the noise of 2e-3 twice,
        // and this doubled for the overshoot.
        let carried = rounding(from, 8e-3);
        let off = [
            (far(over::<Fixed32>(from, COUNT, path.iter().copied())), -25),
            (far(over::<Fixed16>(from, COUNT, path.iter().copied())), -15),
        ];
        for (off, half_step_shown) in off {
            let bound = 2f64.powi(half_step_shown) + carried;
            println!("{from:?}: {off:.2e} of {bound:.2e}");
            assert!(off <= bound, "{from:?}: {off} of {bound}");
        }
    }
}

#[test]
fn nothing_that_a_device_does_breaks_a_filter() {
    fn body<N: Reported>() {
        let mut random = Random::new(13);
        for from in OWN {
            let (filter, mut state) = (velocity::<N>(from, COUNT), VelocityState::default());
            for _ in 0..20_000 {
                // Any positions, and the ends of the range: the states must restart instead of overflowing (`debug_assert` checks
                // it).
                let x = match random.bits() % 4 {
                    0 => 200.0,
                    1 => -200.0,
                    _ => 128.0 * random.real(),
                };
                filter.tick(&mut state, Position::from_f64(x));
            }
            // After that a device at rest is at rest again.
            let mut moved = Position::zero();
            for _ in 0..500 {
                moved = filter.tick(&mut state, Position::zero());
            }
            assert!(moved <= Position::quantum() && moved >= -Position::quantum());
        }
    }
    body::<Fixed32>();
    body::<Fixed16>();
    body::<f64>();
}

fn damper() -> Settings {
    Settings {
        law: LawKind::SpringDamper,
        states: StatesKind::Measured,
        ..Settings::thesis()
    }
}

#[test]
fn a_law_takes_it_only_where_it_is_named() {
    let plain = AnyLaw::<Fixed32>::new(&damper()).unwrap();
    assert!(matches!(plain, AnyLaw::Spring(..)));
    for kind in LawKind::ALL {
        let mut settings = Settings {
            law: *kind,
            ..damper()
        };
        settings.velocity.from = VelocityKind::Foaw;
        let law = AnyLaw::<Fixed32>::new(&settings).unwrap();
        let own = matches!(law, AnyLaw::Damped(..));
        assert_eq!(own, *kind == LawKind::SpringDamper, "{kind:?}");
    }
}

#[test]
fn a_damper_outside_gives_nothing_and_inside_pushes_out_within_the_limit() {
    for from in OWN {
        let mut settings = damper();
        settings.velocity.from = from;
        let mut wall = Controller::<Fixed32>::new(&settings).unwrap();
        let limit = Position::<Fixed32>::from_si(settings.force_limit).unwrap();
        let (mut random, mut touched) = (Random::new(17), 0);
        for _ in 0..20_000 {
            let e = Position::<Fixed32>::from_f64(0.2 * random.real());
            let force = wall.tick(e);
            assert!(force.0 >= 0 && force.0 <= limit.0);
            assert!(e > Position::zero() || force.0 == 0);
            touched += u32::from(force.0 > 0);
        }
        assert!(touched > 5_000, "{from:?}");
    }
}

#[test]
fn a_bandwidth_out_of_range_is_refused_where_it_is_used() {
    let mut settings = damper();
    settings.velocity.bandwidth_hz = si("500");
    let refused = |settings: &Settings| Controller::<Fixed32>::new(settings).err();
    assert_eq!(refused(&settings), None);
    settings.velocity.from = VelocityKind::Foaw;
    assert_eq!(refused(&settings), None);
    settings.velocity.from = VelocityKind::Kalman;
    assert!(matches!(
        refused(&settings),
        Some(SettingsError::OutOfRange {
            field: Field::VelocityBandwidth,
            ..
        })
    ));
    settings.velocity.bandwidth_hz = si("200");
    assert_eq!(refused(&settings), None);
}
