//! The state estimator against an independent one of matrices, and what it promises.

mod reference {
    /// `[x, d, g, f]` in ticks: penetration, displacement per tick, the hand's push per tick², held force.
    type Four = [[f64; 4]; 4];
    type Three = [[f64; 3]; 3];

    fn product<const N: usize>(a: &[[f64; N]; N], b: &[[f64; N]; N]) -> [[f64; N]; N] {
        std::array::from_fn(|i| std::array::from_fn(|j| (0..N).map(|k| a[i][k] * b[k][j]).sum()))
    }

    /// `exp(M t)` by scaling and squaring.
    fn exponential(m: &Four, t: f64) -> Four {
        let identity: Four = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(i == j)));
        let small = m.map(|row| row.map(|x| x * t / 1024.0));
        let (mut sum, mut term) = (identity, identity);
        for k in 1..12 {
            term = product(&term, &small).map(|row| row.map(|x| x / f64::from(k)));
            for i in 0..4 {
                for j in 0..4 {
                    sum[i][j] += term[i][j];
                }
            }
        }
        for _ in 0..10 {
            sum = product(&sum, &sum);
        }
        sum
    }

    fn inverse(m: &Three) -> Three {
        let minor = |i: usize, j: usize| {
            let at = |a: usize, b: usize| m[(i + a) % 3][(j + b) % 3];
            at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1)
        };
        let determinant: f64 = (0..3).map(|j| m[0][j] * minor(0, j)).sum();
        std::array::from_fn(|i| std::array::from_fn(|j| minor(j, i) / determinant))
    }

    /// One device as it is believed to be.
    pub struct Reference {
        motion: Four,
        pub step: Three,
        pub gains: [f64; 3],
        delay: f64,
        pub state: Option<[f64; 3]>,
        /// The latest last.
        commands: Vec<f64>,
    }

    impl Reference {
        /// Poles at `z`; `b T/J`, `T²/J`, delay in ticks.
        pub fn new(z: f64, loss: f64, per_force: f64, delay: f64) -> Self {
            let motion = [
                [0.0, 1.0, 0.0, 0.0],
                [0.0, -loss, 1.0, -per_force],
                [0.0; 4],
                [0.0; 4],
            ];
            let whole = exponential(&motion, 1.0);
            let f: Three = std::array::from_fn(|i| std::array::from_fn(|j| whole[i][j]));
            // Ackermann: (F - z)³ O⁻¹ e₃ with the rows C F, C F², C F³, as the correction comes after the prediction.
            let shifted: Three =
                std::array::from_fn(|i| std::array::from_fn(|j| f[i][j] - z * f64::from(i == j)));
            let wanted = product(&product(&shifted, &shifted), &shifted);
            let (f2, f3) = (product(&f, &f), product(&product(&f, &f), &f));
            let observed = inverse(&[f[0], f2[0], f3[0]]);
            let gains =
                std::array::from_fn(|i| (0..3).map(|k| wanted[i][k] * observed[k][2]).sum());
            Self {
                motion,
                step: f,
                gains,
                delay,
                state: None,
                commands: vec![0.0; 8],
            }
        }

        fn moved(&self, state: [f64; 3], force: f64, time: f64) -> [f64; 3] {
            let e = exponential(&self.motion, time);
            let [x, d, g] = state;
            std::array::from_fn(|i| e[i][0] * x + e[i][1] * d + e[i][2] * g + e[i][3] * force)
        }

        /// Command so many ticks back, 1 for the last.
        fn back(&self, ticks: usize) -> f64 {
            self.commands[self.commands.len() - ticks]
        }

        /// Position and displacement per tick when the next command begins to act.
        pub fn tick(&mut self, measured: f64) -> (f64, f64) {
            let (whole, fraction) = (self.delay.floor() as usize, self.delay.fract());
            let state = match self.state {
                None => [measured, 0.0, 0.0],
                Some(state) => {
                    let state = self.moved(state, self.back(whole + 2), fraction);
                    let state = self.moved(state, self.back(whole + 1), 1.0 - fraction);
                    let r = measured - state[0];
                    std::array::from_fn(|i| state[i] + self.gains[i] * r)
                }
            };
            self.state = Some(state);
            let mut ahead = self.moved(state, self.back(whole + 1), fraction);
            for back in (1..=whole).rev() {
                ahead = self.moved(ahead, self.back(back), 1.0);
            }
            (ahead[0], ahead[1])
        }

        pub fn commanded(&mut self, force: f64) {
            self.commands.remove(0);
            self.commands.push(force);
        }

        /// How an error goes on from tick to tick: `(1 - L C) F`.
        pub fn error_step(&self) -> Three {
            let first = self.step[0];
            std::array::from_fn(|i| {
                std::array::from_fn(|j| self.step[i][j] - self.gains[i] * first[j])
            })
        }
    }
}

use reference::Reference;
use std::f64::consts::TAU;
use touchstone_control::estimator::EstimatorState;
use touchstone_control::{
    Estimator, EstimatorSettings, Field, Fixed8, Fixed16, Fixed32, Force, Number, Position,
    Reported, SettingsError, Si,
};
use touchstone_tests::random::Random;

const LIMIT: Si = Si::lit("0.5");

/// A device: rate, bandwidth, inertia, damping, delay in ticks.
type Device = (u32, &'static str, &'static str, &'static str, f64);
const DEVICES: [Device; 7] = [
    (1000, "60", "0.0001", "0.0004", 1.0),
    (1000, "60", "0.0001", "0.0004", 0.0),
    (1000, "100", "0.00003", "0.00004", 0.37),
    (1000, "20", "0.001", "0.5", 1.5),
    (4000, "80", "0.2", "2.5", 2.0),
    (10000, "60", "0.00001", "0.0004", 0.75),
    (500, "90", "0.00001", "0", 1.5),
];

fn settings(&(rate, p, j, b, delay): &Device) -> EstimatorSettings {
    EstimatorSettings {
        bandwidth_hz: Si::from_str(p).unwrap(),
        inertia: Si::from_str(j).unwrap(),
        damping: Si::from_str(b).unwrap(),
        delay_s: Si::from_num(delay / f64::from(rate)),
    }
}

fn estimator<N: Number>(device: &Device) -> Estimator<N> {
    let built = settings(device).estimator(device.0, LIMIT);
    built.unwrap_or_else(|error| panic!("{device:?}: {error}"))
}

/// The reference of the same device, of what the settings hold.
fn reference(device: &Device) -> Reference {
    let given = settings(device);
    let rate = f64::from(device.0);
    let of = |x: Si| x.to_num::<f64>();
    let angle = TAU * of(given.bandwidth_hz) / rate;
    let inertia = of(given.inertia) * rate * rate;
    let loss = (of(given.damping) * rate / inertia).min(angle);
    Reference::new(
        (-angle).exp(),
        loss,
        1.0 / inertia,
        of(given.delay_s) * rate,
    )
}

/// Plays a moving hand's counts and forces to whoever listens.
fn play(ticks: u32, seed: u64, mut tick: impl FnMut(f64, f64)) {
    let mut random = Random::new(seed);
    let (mut x, mut phase) = (0.1, 0.0);
    for n in 0..ticks {
        phase += 0.002 + 0.02 * f64::from(n % 700) / 700.0;
        x += 1e-4 * f64::sin(phase) + 5e-6 * random.real();
        // A count of 40,000 in a turn, in a step of the format.
        let count = TAU / 40_000.0;
        let e = ((x / count).round() * count * f64::from(1 << 24)).round() / f64::from(1 << 24);
        let f = (0.4 * random.real() * f64::from(1 << 24)).round() / f64::from(1 << 24);
        tick(e, f);
    }
}

#[test]
fn float_agrees_with_the_matrices() {
    for device in &DEVICES {
        let (law, mut state) = (estimator::<f64>(device), EstimatorState::default());
        let mut matrices = reference(device);
        play(3_000, 1, |e, f| {
            let sample = law.tick(&mut state, Position(e));
            let (x, d) = matrices.tick(e);
            // An inertia and a damping per tick in steps of 2.3e-10 N·m/rad, of the smallest inertia that is used.
            let tolerance = 1e-9;
            assert!(
                (sample.e.0 - x).abs() < tolerance,
                "{device:?}: {} {x}",
                sample.e.0
            );
            assert!(
                (sample.moved.0 - d).abs() < tolerance,
                "{device:?}: {} {d}",
                sample.moved.0
            );
            law.commanded(&mut state, Force(f));
            matrices.commanded(f);
        });
    }
}

/// Sum over all ticks of the moduli of an error's way from each state to what is shown, by a pulse into each state.
fn amplification(matrices: &Reference, delay: f64) -> [[f64; 3]; 2] {
    let a = matrices.error_step();
    let mut power: [[f64; 3]; 3] =
        std::array::from_fn(|i| std::array::from_fn(|j| f64::from(i == j)));
    let mut sums = [[0.0; 3]; 2];
    let shown = [[1.0, delay, 0.5 * delay * delay], [0.0, 1.0, delay]];
    for _ in 0..100_000 {
        for (row, weights) in sums.iter_mut().zip(&shown) {
            for j in 0..3 {
                row[j] += (0..3).map(|k| weights[k] * power[k][j]).sum::<f64>().abs();
            }
        }
        power = std::array::from_fn(|i| {
            std::array::from_fn(|j| (0..3).map(|k| a[i][k] * power[k][j]).sum())
        });
    }
    sums
}

/// What rounding does in one tick to each state, and once more in what is shown, from the steps of the format and from how
/// large states and commands became. Half a step of a weight is 2^-27 of a motion and 2^-31 of a torque; a part is cut at
/// 2^-28.
fn rounding(largest: [f64; 3], delay: f64, force: f64) -> ([f64; 3], [f64; 2]) {
    let (weight, torque, part) = (2f64.powi(-27), 2f64.powi(-31), 2f64.powi(-28));
    let [d, g, r] = largest;
    let flow = |time: f64| {
        let of_parts = (time + 0.5 * time * time) * part;
        let of_commands = 4.0 * force * torque;
        [
            weight * (d + g) + of_parts + of_commands,
            weight * (d + g) + (1.0 + time) * part + of_commands,
        ]
    };
    let [x, v] = flow(1.0);
    // The correction: its weights, and the part of the surprise under weights of at most 1, 3/2 and 1.
    let correction = weight * r + 1.5 * part;
    let ahead = flow(delay);
    ([x + correction, v + correction, correction], ahead)
}

#[test]
fn fixed_agrees_with_float_within_what_rounding_adds_up_to() {
    for device in &DEVICES {
        let (exact, mut exact_state) = (estimator::<f64>(device), EstimatorState::default());
        let (fixed, mut fixed_state) = (estimator::<Fixed32>(device), EstimatorState::default());
        let (mut worst, mut largest) = ([0.0_f64; 2], [0.0_f64; 3]);
        let mut last_shown = 0.0;
        play(20_000, 2, |e, f| {
            let a = exact.tick(&mut exact_state, Position(e));
            let b = fixed.tick(&mut fixed_state, Position::from_f64(e));
            worst[0] = worst[0].max((a.e.0 - b.e.to_f64()).abs());
            worst[1] = worst[1].max((a.moved.0 - b.moved.to_f64()).abs());
            let motion = exact_state.motion.unwrap();
            largest[0] = largest[0].max(motion.moved.abs() + 1e-6);
            largest[1] = largest[1].max(motion.pushed.abs() + 1e-6);
            largest[2] = largest[2].max((e - last_shown).abs() + motion.moved.abs() * 2.0);
            last_shown = e;
            exact.commanded(&mut exact_state, Force(f));
            fixed.commanded(&mut fixed_state, Force::from_f64(f));
        });
        let delay = device.4;
        let sums = amplification(&reference(device), delay);
        // Surprises are at most the change of what was measured and of what was expected.
        let (into, ahead) = rounding([largest[0], largest[1], 4.0 * largest[2]], delay, 0.5);
        let shown = 2f64.powi(-25);
        for (index, name) in ["position", "displacement"].iter().enumerate() {
            let sum: f64 = (0..3).map(|j| sums[index][j] * into[j]).sum();
            let bound = sum + ahead[index] + shown;
            println!("{device:?} {name}: {:.2e}, bound {bound:.2e}", worst[index]);
            assert!(
                worst[index] <= bound,
                "{device:?} {name}: {} {bound}",
                worst[index]
            );
        }
    }
}

#[test]
fn at_rest_it_is_exact_and_stays_so_for_ten_million_ticks() {
    for (index, device) in DEVICES.iter().enumerate() {
        let ticks = if index == 0 { 10_000_000 } else { 200_000 };
        let (law, mut state) = (estimator::<Fixed32>(device), EstimatorState::default());
        let e = Position::<Fixed32>::from_f64(0.0123);
        // Nothing but parts that are cut, and what is shown to its nearest step: none for the knobs at 1 kHz.
        let sums = amplification(&reference(device), device.4);
        let (into, ahead) = rounding([0.0; 3], device.4, 0.1);
        let bound = [0, 1].map(|row| {
            let sum: f64 = (0..3).map(|j| sums[row][j] * into[j]).sum();
            if index < 3 {
                0.0
            } else {
                sum + ahead[row] + 2f64.powi(-25)
            }
        });
        // A hand that pushes against a held force: at rest, whatever inertia is assumed.
        let force = Force::from_f64(0.1);
        let start = Position::from_f64(0.01);
        law.tick(&mut state, start);
        law.commanded(&mut state, force);
        for n in 0..ticks {
            let sample = law.tick(&mut state, e);
            if n > 4_000 {
                let (x, d) = (sample.e.to_f64() - e.to_f64(), sample.moved.to_f64());
                assert!(
                    x.abs() <= bound[0] && d.abs() <= bound[1],
                    "{device:?} {n}: {x} {d}"
                );
            }
            law.commanded(&mut state, force);
        }
    }
}

#[test]
fn all_three_poles_are_where_the_bandwidth_puts_them() {
    for device in &DEVICES {
        let law = estimator::<f64>(device);
        let exact = reference(device);
        for i in 0..3 {
            let (own, other) = (law.correction[i], exact.gains[i]);
            assert!(
                (own - other).abs() < 1e-8,
                "{device:?} gain {i}: {own} {other}"
            );
        }
        // (1 - L C) F with the weights as they are in the format: its characteristic polynomial is (s - z)³.
        let fixed = estimator::<Fixed32>(device);
        let weight = |bits: i32| f64::from(bits) / f64::from(1 << 26);
        let (v, x, loss) = (
            weight(fixed.tick.reach),
            weight(fixed.tick.drift),
            weight(fixed.tick.loss),
        );
        let [a, b, g] = fixed.correction.map(weight);
        let rows = [[1.0, v, x], [0.0, 1.0 - loss, v], [0.0, 0.0, 1.0]];
        let m: [[f64; 3]; 3] = std::array::from_fn(|i| {
            std::array::from_fn(|j| rows[i][j] - [a, b, g][i] * rows[0][j])
        });
        let trace = m[0][0] + m[1][1] + m[2][2];
        let minors = m[0][0] * m[1][1] - m[0][1] * m[1][0] + m[0][0] * m[2][2] - m[0][2] * m[2][0]
            + m[1][1] * m[2][2]
            - m[1][2] * m[2][1];
        let determinant = (1.0 - a) * (1.0 - loss);
        let z = (-TAU * device.1.parse::<f64>().unwrap() / f64::from(device.0)).exp();
        let off = [
            trace - 3.0 * z,
            minors - 3.0 * z * z,
            determinant - z * z * z,
        ];
        assert!(off.iter().all(|x| x.abs() < 3e-7), "{device:?}: {off:?}");
        // Jury: all roots inside the unit circle, of the weights as stored.
        let (c2, c1, c0) = (-trace, minors, -determinant);
        assert!(
            1.0 + c2 + c1 + c0 > 0.0 && 1.0 - c2 + c1 - c0 > 0.0,
            "{device:?}"
        );
        assert!(
            c0.abs() < 1.0 && (c0 * c0 - 1.0).abs() > (c0 * c2 - c1).abs(),
            "{device:?}"
        );
    }
}

/// A knob of its own inertia in a soft grip, against a force that changes every 50 ms; `tick` is told the motion at each
/// sample and the force that acts from then on.
fn knob(inertia: f64, ticks: u32, mut tick: impl FnMut(u32, f64, f64, f64)) {
    const PARTS: u32 = 200;
    let t = 1e-3 / f64::from(PARTS);
    let (mut x, mut v) = (0.0_f64, 0.0_f64);
    for n in 0..ticks {
        let force = if n / 50 % 2 == 0 { 0.05 } else { 0.1 };
        tick(n, x, v * 1e-3, force);
        for _ in 0..PARTS {
            let a = (0.075 - 0.05 * x - 0.0005 * v - force) / inertia;
            v += a * t;
            x += v * t;
        }
    }
}

#[test]
fn a_wrong_inertia_costs_what_the_force_changes_by_and_no_more() {
    let device = (1000, "60", "0.0001", "0", 0.0);
    let [right, light, heavy] = [1e-4, 0.5e-4, 2e-4].map(|inertia| {
        let (law, mut state) = (estimator::<f64>(&device), EstimatorState::default());
        let mut worst = 0.0_f64;
        knob(inertia, 3_000, |n, x, d, force| {
            let sample = law.tick(&mut state, Position(x));
            law.commanded(&mut state, Force(force));
            if n > 500 {
                worst = worst.max((sample.moved.0 - d).abs());
            }
        });
        worst
    });
    // A force that changes by 0.05 N·m pushes by that much of the difference of T²/J in every tick from then on; `X` is 1/2
    // and `V` 1. The grip's own pushes come on top, and are those of a device half or twice as quick.
    let sums = amplification(&reference(&device), 0.0)[1];
    let bound = |inertia: f64| {
        let push = 0.05 * 1e-6 * (1.0 / inertia - 1e4_f64).abs();
        push * (0.5 * sums[0] + sums[1]) + 3.0 * right
    };
    println!("displacement per tick off by {right:.1e}; {light:.1e}, {heavy:.1e} rad");
    assert!(right < 2e-4 && light > right && heavy > right);
    assert!(
        light < bound(0.5e-4) && heavy < bound(2e-4),
        "{} {}",
        bound(0.5e-4),
        bound(2e-4)
    );
}

#[test]
fn nothing_overflows_whatever_is_measured_and_jumps_are_forgotten() {
    fn hammer<N: Reported>(seed: u64) {
        let mut random = Random::new(seed);
        for device in &DEVICES {
            let Ok(law) = settings(device).estimator::<N>(device.0, LIMIT) else {
                continue;
            };
            let mut state = EstimatorState::default();
            for n in 0..20_000 {
                // Anywhere, slowly, at the ends, to and fro: debug builds panic where a sum does not fit.
                let e = match n / 500 % 5 {
                    0 => 128.0 * random.real(),
                    1 => 2.0 * random.real(),
                    2 => [127.9, -128.0][n % 2],
                    3 => [7.9, 0.0][n / 2 % 2],
                    _ => 127.0 + 0.9 * random.real(),
                };
                law.tick(&mut state, Position::from_f64(e));
                law.commanded(&mut state, Force::from_f64(128.0 * random.real()));
            }
            let still = Position::from_f64(0.25);
            for n in 0..4_000 {
                let sample = law.tick(&mut state, still);
                law.commanded(&mut state, Force::zero());
                if n > 3_000 {
                    let off = (sample.e - still).modulus().max(sample.moved.modulus());
                    assert!(off.to_f64() <= 2f64.powi(-23), "{device:?}: {sample:?}");
                }
            }
        }
    }
    hammer::<Fixed32>(3);
    hammer::<Fixed16>(4);
    hammer::<Fixed8>(5);
    hammer::<f64>(6);
}

#[test]
fn the_first_tick_shows_what_is_measured() {
    let (law, mut state) = (estimator::<Fixed32>(&DEVICES[0]), EstimatorState::default());
    let e = Position::from_f64(-3.25);
    let sample = law.tick(&mut state, e);
    assert_eq!((sample.e, sample.moved), (e, Position::zero()));
}

#[test]
fn settings_out_of_range_are_refused_by_name_and_their_limits_accepted() {
    let good = EstimatorSettings::default();
    let lit = |text: &str| Si::from_str(text).unwrap();
    assert_eq!(good.validate(1000, LIMIT), Ok(()));
    /// Field, how it is set, both ends of what is accepted, what is refused beyond them.
    type Case = (
        Field,
        fn(&mut EstimatorSettings, Si),
        [&'static str; 2],
        [&'static str; 2],
    );
    let cases: [Case; 4] = [
        (
            Field::EstimatorBandwidth,
            |s, x| s.bandwidth_hz = x,
            ["2", "200"],
            ["1.9", "201"],
        ),
        (
            Field::EstimatorInertia,
            |s, x| s.inertia = x,
            ["0.0000008", "60"],
            ["0.0000007", "60.1"],
        ),
        (
            Field::EstimatorDamping,
            |s, x| s.damping = x,
            ["0", "10000"],
            ["-0.1", "10001"],
        ),
        (
            Field::EstimatorDelay,
            |s, x| s.delay_s = x,
            ["0", "2"],
            ["-0.001", "2.1"],
        ),
    ];
    for (field, set, inside, outside) in cases {
        for text in inside {
            let mut settings = good;
            set(&mut settings, lit(text));
            assert_eq!(
                settings.validate(1000, LIMIT),
                Ok(()),
                "{} {text}",
                field.path()
            );
            assert!(
                settings.estimator::<Fixed32>(1000, LIMIT).is_ok(),
                "{} {text}",
                field.path()
            );
        }
        for text in outside {
            let mut settings = good;
            set(&mut settings, lit(text));
            let error = settings.validate(1000, LIMIT).unwrap_err();
            let SettingsError::OutOfRange {
                field: named,
                value,
                min,
                max,
            } = error
            else {
                panic!("{error}")
            };
            assert_eq!(named, field, "{text}");
            assert!(value < min || value > max, "{error}");
            assert!(error.to_string().contains(field.path()), "{error}");
        }
    }
}
