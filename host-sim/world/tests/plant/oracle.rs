//! Independent reference for the tests of plants: the equations of motion in absolute angles, without code of the plants.

use touchstone_world::plant::{Coulomb, Device, Hand};

/// A knob with a fifth of the inertia of the thesis' knob, and a damping of 3e-4 N·m·s/rad, so low that the fingertip pad has an
/// effect.
pub const KNOB: Device = Device {
    inertia: 2e-5,
    damping: 3e-4,
    friction: None,
};

/// Dry friction: 2 mN·m in motion, 3 mN·m to break away.
pub const FRICTION: Coulomb = Coulomb {
    kinetic: 2e-3,
    breakaway: 3e-3,
};

pub const STICKY_KNOB: Device = Device {
    friction: Some(FRICTION),
    ..KNOB
};

/// The state `[x, v, x_h, v_h]` (angle and velocity of device and hand), followed by integrated losses: `b ∫v²`, `∫|v|` and `b_h
/// ∫v_h² + b_p ∫(v - v_h)²`.
pub type Full = [f64; 7];

pub struct Oracle {
    pub device: Device,
    pub hand: Option<Hand>,
}

impl Oracle {
    fn pad(&self, z: &Full) -> f64 {
        self.hand.map_or(0.0, |hand| {
            hand.pad_stiffness * (z[2] - z[0]) + hand.pad_damping * (z[3] - z[1])
        })
    }

    fn rates(&self, z: &Full, u: f64, r: f64, stuck: bool) -> Full {
        let [_, v, x_h, v_h, ..] = *z;
        let pad = self.pad(z);
        let b = self.device.damping;
        let mut rates = [
            v,
            (u + pad - b * v) / self.device.inertia,
            0.0,
            0.0,
            b * v * v,
            v.abs(),
            0.0,
        ];
        if let Some(hand) = self.hand {
            rates[2] = v_h;
            rates[3] = (hand.stiffness * (r - x_h) - hand.damping * v_h - pad) / hand.inertia;
            rates[6] = hand.damping * v_h * v_h + hand.pad_damping * (v - v_h) * (v - v_h);
        }
        if stuck {
            (rates[0], rates[1]) = (0.0, 0.0);
        }
        rates
    }

    /// One step of the classical Runge–Kutta method, of length `h` seconds, under the torque `u` and the rest point `r`.
    fn substep(&self, z: &Full, u: f64, r: f64, stuck: bool, h: f64) -> Full {
        let shifted = |k: &Full, f: f64| std::array::from_fn(|i| z[i] + f * k[i]);
        let k1 = self.rates(z, u, r, stuck);
        let k2 = self.rates(&shifted(&k1, h / 2.0), u, r, stuck);
        let k3 = self.rates(&shifted(&k2, h / 2.0), u, r, stuck);
        let k4 = self.rates(&shifted(&k3, h), u, r, stuck);
        std::array::from_fn(|i| z[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
    }

    /// Advances the linear plant by `h` seconds in `n` Runge–Kutta steps, under the torque `u` and the rest point `r`.
    pub fn runge_kutta(&self, z: &Full, u: f64, r: f64, h: f64, n: u32) -> Full {
        (0..n).fold(*z, |z, _| self.substep(&z, u, r, false, h / f64::from(n)))
    }

    /// Advances the plant with friction by `h` seconds in `n` steps, and locates every stop and start by bisection. Also returns
    /// the number of stops and starts.
    pub fn with_events(&self, z: &Full, u: f64, r: f64, h: f64, n: u32) -> (Full, u32) {
        let friction = self.device.friction.expect("an oracle with friction");
        let mut z = *z;
        let at_rest = |z: &Full| u + self.pad(z);
        let mut mode = if z[1] != 0.0 {
            z[1].signum()
        } else if at_rest(&z).abs() > friction.breakaway {
            at_rest(&z).signum()
        } else {
            0.0
        };
        let mut events = 0;
        for _ in 0..n {
            let mut left = h / f64::from(n);
            while left > 0.0 {
                let go = |t: f64| self.substep(&z, u - mode * friction.kinetic, r, mode == 0.0, t);
                let over = |z: &Full| {
                    if mode == 0.0 {
                        at_rest(z).abs() > friction.breakaway
                    } else {
                        mode * z[1] < 0.0
                    }
                };
                if !over(&go(left)) {
                    z = go(left);
                    break;
                }
                let (mut before, mut after) = (0.0, left);
                for _ in 0..80 {
                    let middle = 0.5 * (before + after);
                    if over(&go(middle)) {
                        after = middle
                    } else {
                        before = middle
                    }
                }
                z = go(after);
                left -= after;
                events += 1;
                mode = if mode == 0.0 || at_rest(&Full::from_rest(&z)).abs() > friction.breakaway {
                    at_rest(&Full::from_rest(&z)).signum()
                } else {
                    0.0
                };
                z[1] = 0.0;
            }
        }
        (z, events)
    }

    /// Advances the plant with friction by `h` seconds in `n` steps of the implicit Euler method with set-valued friction (Kikuuwe
    /// et al., T-RO 22(6) 1176, 2006). The method is of first order, lets the device rest exactly, and does not locate stops and
    /// starts.
    pub fn implicit_euler(&self, z: &Full, u: f64, r: f64, h: f64, n: u32) -> Full {
        let friction = self.device.friction.expect("an oracle with friction");
        let h = h / f64::from(n);
        let (j, b) = (self.device.inertia, self.device.damping);
        let mut z = *z;
        for _ in 0..n {
            let rates = self.rates(&z, u, r, false);
            let impulse = j / h * z[1] + u + self.pad(&z);
            let level = if z[1] == 0.0 {
                friction.breakaway
            } else {
                friction.kinetic
            };
            z[1] = if impulse.abs() <= level {
                0.0
            } else {
                (impulse - friction.kinetic.copysign(impulse)) / (j / h + b)
            };
            z[0] += h * z[1];
            z[3] += h * rates[3];
            z[2] += h * z[3];
        }
        z
    }
}

trait FromRest {
    fn from_rest(z: &Full) -> Full;
}

impl FromRest for Full {
    fn from_rest(z: &Full) -> Full {
        let mut z = *z;
        z[1] = 0.0;
        z
    }
}

/// A small deterministic generator of pseudo-random numbers (xorshift), uniform in `[-1, 1)`.
pub struct Random(pub u64);

impl Random {
    pub fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// Compares two states after a step. Differences are relative to the largest magnitude before or after the step, among angles and
/// among velocities. A step adds an increment, so a value that decays to zero within a step keeps the rounding error of its earlier
/// value.
pub fn assert_close<const N: usize>(
    value: [f64; N],
    expected: &[f64],
    before: &[f64],
    tolerance: f64,
    what: &str,
) {
    for parity in 0..2 {
        let pick = |i: &usize| i % 2 == parity;
        let scale = (0..N).filter(pick).fold(f64::MIN_POSITIVE, |s, i| {
            expected[i].abs().max(before[i].abs()).max(s)
        });
        for i in (0..N).filter(pick) {
            let error = (value[i] - expected[i]).abs() / scale;
            assert!(
                error <= tolerance,
                "{what}: entry {i} is {} for {}, off by {error:e}",
                value[i],
                expected[i]
            );
        }
    }
}
