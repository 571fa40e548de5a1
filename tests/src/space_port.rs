//! Simulates the mechanical port between a three-axis device and a hand, sums the energy exactly, and has hands that try to get
//! energy out. The modules `port` and `adversary` do the same for one axis.

use touchstone_control::space::{LengthUnit, Vector, VectorGuard};
use touchstone_control::{ChangeOfForce, GuardSettings, GuardedDevice, Si};

use crate::search;
use crate::space::{F, Push, at, dot, length, newton, push_in_n};

/// Control period, s.
pub const TICK_S: f64 = 1e-3;
/// Damping that the energy guard relies on, in N for each mm per control period: 80 % of the configured damping. The simulated
/// device has no more damping than that.
pub const TRUSTED_N_PER_MM_TICK: f64 = 0.8 * 2.5;
/// One encoder count, mm.
pub const COUNT_MM: f64 = 0.01;
/// Displacement per control period, mm, above which the energy guard switches the force off.
pub const FASTEST_MM: f64 = 1.0;
/// Capacity of the energy guard's account, mJ.
pub const CAPACITY_MJ: f64 = 20.0;
/// Power that refills the energy guard's account, mW.
pub const REFILL_MW: f64 = 0.5;

/// A control law: the requested force in N as a function of the position in mm.
pub type Law = fn([f64; 3]) -> [f64; 3];

/// Force in N of a virtual ball of 30 mm radius: a spring outwards of 25 N/mm, at most 12 N.
#[must_use]
pub fn ball(x: [f64; 3]) -> [f64; 3] {
    let r = length(x).max(1e-9);
    let force = (25.0 * (30.0 - r)).clamp(0.0, 12.0);
    x.map(|part| force * part / r)
}

/// Force in N that drives the hand in circles. It gives energy in every circle, so that only the energy guard bounds it.
#[must_use]
pub fn whirl(x: [f64; 3]) -> [f64; 3] {
    let [a, b, c] = x.map(|part| part / 2.0);
    [
        (b + c).tanh() * 12.0,
        (c - a).tanh() * 12.0,
        (a - b).tanh() * 12.0,
    ]
}

/// The simulated port on three axes: device, control law and energy guard, which a hand moves.
#[derive(Debug, Clone, Copy)]
pub struct Port {
    /// The control law that requests the force.
    pub law: Law,
    /// Delay from sample to force in control periods, 0 to 1.
    pub delay_ticks: f64,
    /// Delay in control periods for which the energy guard is configured; `None` for no guard.
    pub guard_delay: Option<f64>,
}

/// Result of simulating a hand on three axes; energies in mJ.
#[derive(Debug, Clone, Copy, Default)]
pub struct Outcome {
    /// Most energy in mJ that the hand got out in any time window, minus the energy that refilled the energy guard's account in
    /// that window.
    pub above_refill: f64,
    /// Number of control periods in which the energy guard reduced the force.
    pub shortened: u32,
    /// Largest angle between the requested force and the force that the energy guard let through, rad.
    pub turned: f64,
}

impl Port {
    fn guard(delay_ticks: f64) -> VectorGuard<F> {
        let si = |value: f64| Si::from_num(value);
        let (settings, device) = LengthUnit::Centimetre.guard(
            &GuardSettings {
                capacity: si(CAPACITY_MJ * 1e-3),
                refill: si(REFILL_MW * 1e-3),
                share_of_damping: si(0.8),
                overspeed: si(FASTEST_MM),
                delay: si(delay_ticks * TICK_S),
                lag: Si::ZERO,
                on: true,
                damping: si(2.5),
                change: ChangeOfForce::Estimated,
            },
            &GuardedDevice {
                rate_hz: 1000,
                force_limit: si(12.0),
                count: si(COUNT_MM * 1e-3),
            },
        );
        VectorGuard::new(&settings, &device).expect("settings")
    }

    /// Simulates a hand of this type with the parameters `numbers` for this many control periods.
    #[must_use]
    pub fn play(&self, way: Way, numbers: &[f64], ticks: u32) -> Outcome {
        let guard = self.guard_delay.map(Self::guard);
        let mut state = guard.map(|guard| guard.full());
        let mut hand = HandState::new(way, numbers, self.delay_ticks);
        let (mut last, mut now) = (None, [0.0; 3]);
        let mut outcome = Outcome::default();
        // Energy got out in total, and the least total at the start of a tick so far, where the best window began.
        let (mut total, mut least) = (0.0_f64, 0.0_f64);
        for tick in 0..ticks {
            let count = |x: f64| (x / COUNT_MM).round() * COUNT_MM;
            let [x, y, z] = hand.at.map(count);
            let measured = at(x, y, z);
            let moved = last.map_or(Vector::default(), |last| measured - last);
            last = Some(measured);
            let [fx, fy, fz] = (self.law)([x, y, z]);
            let wanted: Push = Vector([newton(fx), newton(fy), newton(fz)]);
            let force = match (&guard, &mut state) {
                (Some(guard), Some(state)) => {
                    let Ok(force) = guard.tick(state, moved, wanted) else {
                        break;
                    };
                    force
                }
                _ => wanted,
            };
            if force != wanted {
                outcome.shortened += 1;
                let (a, b) = (push_in_n(force), push_in_n(wanted));
                if length(a) > 0.01 {
                    outcome.turned = outcome.turned.max(crate::space::angle(a, b));
                }
            }
            let old = std::mem::replace(&mut now, push_in_n(force));
            least = least.min(total);
            for (late, acting) in [(false, old), (true, now)] {
                let seconds = if late {
                    1.0 - self.delay_ticks
                } else {
                    self.delay_ticks
                };
                if seconds <= 0.0 {
                    continue;
                }
                let step = hand.go(tick, late, acting, seconds);
                let damped = TRUSTED_N_PER_MM_TICK * dot(step, step) / seconds;
                // N·mm are mJ; 0.5 mW are 0.5 µJ per tick.
                total += dot(acting, step) - damped - REFILL_MW * 1e-3 * seconds;
                outcome.above_refill = outcome.above_refill.max(total - least);
            }
        }
        outcome
    }

    /// Searches for the worst hand of this type with this many evaluations. Returns its parameters, and the most energy in mJ that
    /// it got beyond the energy that refills the energy guard's account.
    #[must_use]
    pub fn worst(&self, way: Way, evaluations: u32, ticks: u32, seed: u64) -> (Vec<f64>, f64) {
        search::largest(way.dimensions(), 0.5, evaluations, seed, |numbers| {
            self.play(way, numbers, ticks).above_refill
        })
    }
}

/// A type of simulated hand on three axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// A motion that repeats every six control periods. The parts of a period before and after the change of force have their own
    /// velocities.
    Periodic,
    /// A hand that reacts to the force: its velocity before and after the change of force in a control period depends on the force
    /// and the force's change.
    Policy,
    /// A circular motion from two perpendicular sines, and a third sine along the circle's axis.
    Circles,
}

const PERIOD: usize = 6;

impl Way {
    /// All types of hand.
    pub const ALL: [Way; 3] = [Way::Periodic, Way::Policy, Way::Circles];

    /// Number of parameters that describe a hand of this type.
    #[must_use]
    pub fn dimensions(self) -> usize {
        match self {
            Way::Periodic => 2 * 3 * PERIOD + 2,
            Way::Policy => 2 * 5 + 2,
            Way::Circles => 9,
        }
    }
}

struct HandState {
    way: Way,
    numbers: Vec<f64>,
    delay: f64,
    at: [f64; 3],
    before: [f64; 3],
    force: [f64; 3],
    change: [f64; 3],
    time: f64,
}

impl HandState {
    fn new(way: Way, numbers: &[f64], delay: f64) -> Self {
        Self {
            way,
            numbers: numbers.to_vec(),
            delay,
            // Starts just outside the ball.
            at: [3.0, 2.0, 29.9],
            before: [0.0; 3],
            force: [0.0; 3],
            change: [0.0; 3],
            time: 0.0,
        }
    }

    /// Limits a displacement vector to 97 % of what the energy guard's speed limit allows in this many control periods.
    fn limited(step: [f64; 3], ticks: f64) -> [f64; 3] {
        // Leaves room for the counts by which a measurement may be wrong: the bound does not hold at an over-speed.
        let most = 0.97 * FASTEST_MM * ticks;
        let size = length(step);
        if size > most {
            step.map(|x| x * most / size)
        } else {
            step
        }
    }

    fn go(&mut self, tick: u32, late: bool, force: [f64; 3], ticks: f64) -> [f64; 3] {
        if late {
            self.change = std::array::from_fn(|i| force[i] - self.force[i]);
            self.force = force;
        }
        let n = &self.numbers;
        let wish: [f64; 3] = match self.way {
            Way::Periodic => {
                const ENTER: u32 = 60;
                if tick < ENTER {
                    let deep = n[0].abs().min(1.0) * 0.01;
                    self.at.map(|x| -deep * x / 30.0 * ticks)
                } else {
                    let phase = (tick - ENTER) as usize % PERIOD;
                    let size = 0.2 * (2.0 * n[1]).clamp(-8.0, 2.0).exp();
                    let of =
                        |half: usize, phase: usize, i: usize| n[2 + (2 * phase + half) * 3 + i];
                    std::array::from_fn(|i| {
                        // The mean of a period is subtracted, so that the motion comes back to its start.
                        let mean: f64 = (0..PERIOD)
                            .map(|p| of(0, p, i) * self.delay + of(1, p, i) * (1.0 - self.delay))
                            .sum::<f64>()
                            / PERIOD as f64;
                        size * (of(usize::from(late), phase, i) - mean) * ticks
                    })
                }
            }
            Way::Policy => {
                let from = if late { 5 } else { 0 };
                let size = FASTEST_MM * (2.0 * n[10] - 2.0).clamp(-9.0, 0.5).exp();
                let phase = 0.3 * (1.2 * n[11]).clamp(-3.0, 2.3).exp() * f64::from(tick);
                let centre = 1.0 / length(self.at).max(1.0);
                std::array::from_fn(|i| {
                    let features = [
                        self.force[i] / 6.0,
                        self.change[i] / 2.0,
                        self.at[i] * centre * phase.sin(),
                        3.0 * self.before[i],
                        -self.at[i] * centre,
                    ];
                    let sum: f64 = features.iter().zip(&n[from..]).map(|(f, w)| f * w).sum();
                    size * sum.tanh() * ticks
                })
            }
            Way::Circles => {
                self.time += ticks;
                let omega = |k: usize| 0.126 * (1.2 * n[k]).clamp(-3.0, 2.3).exp();
                let grown = (self.time / 100.0).min(1.0);
                let wave = |k: usize| {
                    let w = omega(3 * k);
                    grown * n[3 * k + 1] * (w * self.time + n[3 * k + 2]).sin()
                };
                let to = [3.0 + wave(0), 2.0 + wave(1), 29.6 + wave(2)];
                std::array::from_fn(|i| to[i] - self.at[i])
            }
        };
        let step = Self::limited(wish, ticks);
        self.before = step;
        for (x, step) in self.at.iter_mut().zip(step) {
            *x += step;
        }
        step
    }
}
