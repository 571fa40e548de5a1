//! A reference for the state estimator (position and speed from a model of the device). It is calculated independently with
//! matrices. Also has the devices on which tests compare the estimator with it.

use std::f64::consts::TAU;

use touchstone_control::{Estimator, EstimatorSettings, Number, Si};

use crate::random::Random;

/// Matrix for the state `[x, d, g, f]`, with the control period as unit of time: penetration, displacement per period, the hand's
/// acceleration per period², and the held force.
type Four = [[f64; 4]; 4];
type Three = [[f64; 3]; 3];

fn product<const N: usize>(a: &[[f64; N]; N], b: &[[f64; N]; N]) -> [[f64; N]; N] {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..N).map(|k| a[i][k] * b[k][j]).sum()))
}

/// The matrix exponential `exp(M t)`, calculated by scaling and squaring.
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

/// The state estimator in matrix form, for a device that is exactly as the estimator assumes.
pub struct Reference {
    motion: Four,
    /// Matrix that moves the state `[x, d, g]` (penetration, displacement per period, hand's acceleration) on by one control
    /// period.
    pub step: Three,
    /// Gains by which the measured position corrects the state `[x, d, g]` (penetration, displacement per period, hand's
    /// acceleration).
    pub gains: [f64; 3],
    delay: f64,
    /// State `[x, d, g]` (penetration, displacement per period, hand's acceleration) at the last sample; `None` before the first.
    pub state: Option<[f64; 3]>,
    /// Past force commands in N·m, the latest last.
    commands: Vec<f64>,
}

impl Reference {
    /// The estimator with all poles at `z`. The device has damping `b` and inertia `J`, the control period is `T`: `loss` is `b
    /// T/J`, `per_force` is `T²/J`, and `delay` is in control periods.
    pub fn new(z: f64, loss: f64, per_force: f64, delay: f64) -> Self {
        let motion = [
            [0.0, 1.0, 0.0, 0.0],
            [0.0, -loss, 1.0, -per_force],
            [0.0; 4],
            [0.0; 4],
        ];
        let whole = exponential(&motion, 1.0);
        let f: Three = std::array::from_fn(|i| std::array::from_fn(|j| whole[i][j]));
        // Ackermann's formula for the gains: (F - z)³ O⁻¹ e₃, with the state matrix F, the measurement row C and the third unit
        // vector e₃. O has the rows C F, C F², C F³ instead of C, C F, C F², because the correction comes after the prediction.
        let shifted: Three =
            std::array::from_fn(|i| std::array::from_fn(|j| f[i][j] - z * f64::from(i == j)));
        let wanted = product(&product(&shifted, &shifted), &shifted);
        let (f2, f3) = (product(&f, &f), product(&product(&f, &f), &f));
        let observed = inverse(&[f[0], f2[0], f3[0]]);
        let gains = std::array::from_fn(|i| (0..3).map(|k| wanted[i][k] * observed[k][2]).sum());
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

    /// The force command `ticks` control periods ago, N·m; 1 is the last command.
    fn back(&self, ticks: usize) -> f64 {
        self.commands[self.commands.len() - ticks]
    }

    /// Runs one control period with a measured position. Returns position and displacement per period at the time when the next
    /// command begins to act.
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

    /// Reports the commanded force to the estimator, N·m. The force begins to act after the delay.
    pub fn commanded(&mut self, force: f64) {
        self.commands.remove(0);
        self.commands.push(force);
    }

    /// Matrix by which an estimation error changes from one control period to the next: `(1 - L C) F`, with gains `L`, measurement
    /// row `C` and state matrix `F`.
    pub fn error_step(&self) -> Three {
        let first = self.step[0];
        std::array::from_fn(|i| std::array::from_fn(|j| self.step[i][j] - self.gains[i] * first[j]))
    }
}

/// Force limit of the test devices, N·m.
pub const LIMIT: Si = Si::lit("0.5");

/// A row of the table of test devices: control rate in Hz, estimator bandwidth in Hz, inertia in kg·m², damping in N·m·s/rad, and
/// delay in control periods.
pub type DeviceRow = (u32, &'static str, &'static str, &'static str, f64);
/// Test devices from slow to quick, with delays from 0 to two control periods.
pub const DEVICES: [DeviceRow; 7] = [
    (1000, "60", "0.0001", "0.0004", 1.0),
    (1000, "60", "0.0001", "0.0004", 0.0),
    (1000, "100", "0.00003", "0.00004", 0.37),
    (1000, "20", "0.001", "0.5", 1.5),
    (4000, "80", "0.2", "2.5", 2.0),
    (10000, "60", "0.00001", "0.0004", 0.75),
    (500, "90", "0.00001", "0", 1.5),
];

/// The state estimator's settings for a test device.
pub fn settings(&(rate, p, j, b, delay): &DeviceRow) -> EstimatorSettings {
    EstimatorSettings {
        bandwidth_hz: Si::from_str(p).unwrap(),
        inertia: Si::from_str(j).unwrap(),
        damping: Si::from_str(b).unwrap(),
        delay_s: Si::from_num(delay / f64::from(rate)),
    }
}

/// The control crate's state estimator for a test device.
///
/// # Panics
/// The estimator refuses its settings.
pub fn estimator<N: Number>(device: &DeviceRow) -> Estimator<N> {
    let built = settings(device).estimator(device.0, LIMIT);
    built.unwrap_or_else(|error| panic!("{device:?}: {error}"))
}

/// The state estimator in matrix form for a test device, with parameters rounded as the settings round them.
pub fn reference(device: &DeviceRow) -> Reference {
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

/// Simulates a moving hand for this many control periods, from a seed. Calls `tick` with each measured position (rad) and a random
/// force (N·m).
pub fn play(ticks: u32, seed: u64, mut tick: impl FnMut(f64, f64)) {
    let mut random = Random::new(seed);
    let (mut x, mut phase) = (0.1, 0.0);
    for n in 0..ticks {
        phase += 0.002 + 0.02 * f64::from(n % 700) / 700.0;
        x += 1e-4 * f64::sin(phase) + 5e-6 * random.real();
        // Rounds the position to encoder counts (40,000 per turn), and then to 2^-24 rad, the step of `Fixed32`.
        let count = TAU / 40_000.0;
        let e = ((x / count).round() * count * f64::from(1 << 24)).round() / f64::from(1 << 24);
        let f = (0.4 * random.real() * f64::from(1 << 24)).round() / f64::from(1 << 24);
        tick(e, f);
    }
}

/// How much an error in the estimator's state is amplified in its outputs. The state is position, displacement per control period,
/// and the hand's acceleration per period squared. `delay` is in control periods. Row: output (position, displacement per period).
/// Column: state with an initial error of 1. Each entry is the sum of the output's magnitudes over all later control periods.
pub fn amplification(matrices: &Reference, delay: f64) -> [[f64; 3]; 2] {
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
