//! Reference solution for tests of the integration methods, in numbers with twice the digits. Every stop and start of the device is
//! located in time.
//!
//! The code is independent of the plant model. Its equations use absolute angles, and its numbers are of the type `Double`. Its
//! method is Gragg's modified midpoint rule with extrapolation of order 16 (Hairer, Nørsett and Wanner, Solving Ordinary
//! Differential Equations I, II.9). The difference from a second solution with half as many steps is taken as the error.

use super::double::Double;
use touchstone_world::plant::{Device, Hand};

/// State vector: angle and velocity of the device, followed by angle and velocity of a hand, or by the torque of a current
/// controller.
pub type Entries = [Double; 4];

/// Number of columns of the extrapolation table.
const COLUMNS: usize = 8;
/// Largest number of stops and starts that are located in one tick.
const MOST_EVENTS: u32 = 1000;

/// Whether the device slides or friction holds it.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Mode {
    /// The device turns in the direction of the sign (1 or -1). 0 stands for a device without friction, which turns either way.
    Sliding(f64),
    Stuck,
}

/// The plant in its own equations, independent of the simulator's plant.
#[derive(Debug, Clone)]
pub struct Reference {
    device: Device,
    hand: Option<Hand>,
    per_inertia: Double,
    per_hand: Double,
    /// Rate of the current controller's lag, 1/s: 2π times its bandwidth. `None` without a lag.
    pole: Option<f64>,
    /// Number of extrapolated steps per tick (control period).
    steps: u32,
    /// Number of times that friction has stopped the device or let it start.
    pub events: u64,
}

impl Reference {
    /// Makes a reference plant; each tick is divided into `steps` steps.
    #[must_use]
    pub fn new(
        device: &Device,
        hand: Option<&Hand>,
        current_loop_hz: Option<f64>,
        steps: u32,
    ) -> Self {
        Self {
            device: *device,
            hand: hand.copied(),
            per_inertia: Double::from(device.inertia).reciprocal(),
            per_hand: hand.map_or(Double::ZERO, |hand| Double::from(hand.inertia).reciprocal()),
            pole: current_loop_hz.map(|hz| std::f64::consts::TAU * hz),
            steps,
            events: 0,
        }
    }

    /// Force of the finger pad on the device, N·m.
    fn pad(&self, z: &Entries) -> Double {
        self.hand.map_or(Double::ZERO, |hand| {
            Double::from(hand.pad_stiffness) * (z[2] - z[0])
                + Double::from(hand.pad_damping) * (z[3] - z[1])
        })
    }

    fn rate(&self, z: &Entries, [u, r]: [f64; 2], mode: Mode) -> Entries {
        let pad = self.pad(z);
        let mut rate = [z[1], Double::ZERO, Double::ZERO, Double::ZERO];
        let mut drive = Double::from(u);
        if let Some(pole) = self.pole {
            rate[2] = Double::from(pole) * (drive - z[2]);
            drive = z[2];
        }
        match mode {
            Mode::Stuck => rate[0] = Double::ZERO,
            Mode::Sliding(sign) => {
                let friction = self.device.friction.map_or(0.0, |f| sign * f.kinetic);
                rate[1] = self.per_inertia
                    * (drive + pad
                        - Double::from(self.device.damping) * z[1]
                        - Double::from(friction));
            }
        }
        if let Some(hand) = &self.hand {
            rate[2] = z[3];
            rate[3] = self.per_hand
                * (Double::from(hand.stiffness) * (Double::from(r) - z[2])
                    - Double::from(hand.damping) * z[3]
                    - pad);
        }
        rate
    }

    /// Makes one extrapolated step over `h` seconds in the given mode (sliding or stuck).
    fn step(&self, z: &Entries, held: [f64; 2], mode: Mode, h: f64) -> Entries {
        let mut table: [Entries; COLUMNS] = [[Double::ZERO; 4]; COLUMNS];
        for row in 0..COLUMNS {
            let count = 2 * (row + 1);
            let small = Double::from(h) * Double::from(count as f64).reciprocal();
            let twice = small + small;
            let shifted = |base: &Entries, by: Double, rate: &Entries| -> Entries {
                std::array::from_fn(|i| base[i] + by * rate[i])
            };
            let mut before = *z;
            let mut now = shifted(z, small, &self.rate(z, held, mode));
            for _ in 1..count {
                let next = shifted(&before, twice, &self.rate(&now, held, mode));
                (before, now) = (now, next);
            }
            // Gragg's smoothing at the end.
            let last = shifted(&before, small, &self.rate(&now, held, mode));
            let half = Double::from(0.5);
            let mut current: Entries = std::array::from_fn(|i| half * (now[i] + last[i]));
            // Neville's scheme in the square of the step.
            let mut diagonal = table;
            for column in 0..row {
                let ratio = count as f64 / (2 * (row - column)) as f64;
                let factor = Double::from(ratio * ratio - 1.0).reciprocal();
                let older = table[column];
                diagonal[column] = current;
                current = std::array::from_fn(|i| current[i] + factor * (current[i] - older[i]));
            }
            diagonal[row] = current;
            table = diagonal;
        }
        table[COLUMNS - 1]
    }

    /// Torque on a device that does not move, without friction, N·m.
    fn at_rest(&self, z: &Entries, u: f64) -> f64 {
        let mut resting = *z;
        resting[1] = Double::ZERO;
        (Double::from(u) + self.pad(&resting)).to_f64()
    }

    fn mode(&self, z: &Entries, u: f64) -> Mode {
        let Some(friction) = self.device.friction else {
            return Mode::Sliding(0.0);
        };
        let v = z[1].to_f64();
        let push = self.at_rest(z, u);
        if v != 0.0 {
            Mode::Sliding(v.signum())
        } else if push.abs() > friction.breakaway {
            Mode::Sliding(push.signum())
        } else {
            Mode::Stuck
        }
    }

    /// Value that falls below zero at the end of the mode: the speed in the direction of a sliding device (rad/s), or the spare
    /// friction of a stuck one (N·m). Without friction a mode does not end.
    fn margin(&self, z: &Entries, u: f64, mode: Mode) -> f64 {
        match (self.device.friction, mode) {
            (None, _) => 1.0,
            (Some(_), Mode::Sliding(sign)) => sign * z[1].to_f64(),
            (Some(friction), Mode::Stuck) => friction.breakaway - self.at_rest(z, u).abs(),
        }
    }

    /// Advances the state by one tick of `period_s` with a constant motor torque and hand's rest point (`held`).
    pub fn tick(&mut self, z: &mut Entries, held: [f64; 2], period_s: f64) {
        let mut mode = self.mode(z, held[0]);
        let whole = period_s / f64::from(self.steps);
        let mut events = 0;
        for _ in 0..self.steps {
            let mut left = whole;
            while left > 0.0 {
                let end = self.step(z, held, mode, left);
                if self.margin(&end, held[0], mode) >= 0.0 || events >= MOST_EVENTS {
                    *z = end;
                    break;
                }
                let (mut before, mut after) = (0.0, left);
                for _ in 0..100 {
                    let middle = 0.5 * (before + after);
                    if middle <= before || middle >= after {
                        break;
                    }
                    if self.margin(&self.step(z, held, mode, middle), held[0], mode) < 0.0 {
                        after = middle;
                    } else {
                        before = middle;
                    }
                }
                *z = self.step(z, held, mode, after);
                left -= after;
                events += 1;
                mode = match mode {
                    Mode::Stuck => Mode::Sliding(self.at_rest(z, held[0]).signum()),
                    Mode::Sliding(_) => {
                        z[1] = Double::ZERO;
                        self.mode(z, held[0])
                    }
                };
            }
        }
        self.events += u64::from(events);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use touchstone_world::plant::Coulomb;

    #[test]
    fn a_decay_and_a_stop_have_their_closed_forms() {
        let device = Device {
            inertia: 1e-4,
            damping: 5e-4,
            friction: None,
        };
        let mut free = Reference::new(&device, None, None, 2);
        let mut z = [Double::ZERO, Double::from(1.0), Double::ZERO, Double::ZERO];
        for _ in 0..200 {
            free.tick(&mut z, [0.0; 2], 1e-3);
        }
        // x = v₀ (J/b) (1 - exp(-b t/J)), with b t/J = 1.
        let expected = 0.2 * -(-1.0_f64).exp_m1();
        assert!((z[0].to_f64() - expected).abs() < 1e-16, "{:?}", z[0]);

        let mut sticky = Reference::new(
            &Device {
                friction: Some(Coulomb {
                    kinetic: 2e-3,
                    breakaway: 3e-3,
                }),
                ..device
            },
            None,
            None,
            2,
        );
        let mut z = [Double::ZERO, Double::from(1.0), Double::ZERO, Double::ZERO];
        for _ in 0..200 {
            sticky.tick(&mut z, [0.0; 2], 1e-3);
        }
        // Stops after (J/b) ln(1 + b v₀/F), here 44.6 ms, at (J/b) (v₀ - (F/b) ln(1 + b v₀/F)).
        let log = 0.25_f64.ln_1p();
        let expected = 0.2 * (1.0 - 4.0 * log);
        assert!(
            (z[0].to_f64() - expected).abs() < 1e-16,
            "{:?} {expected}",
            z[0]
        );
        assert_eq!((z[1].to_f64(), sticky.events), (0.0, 1));
    }
}
