//! Simulated hands that try to get energy out of a device. A few numbers describe each hand's motion or reaction. [`crate::search`]
//! finds the numbers of the worst hand.

use crate::port::{Gripped, Hand, Imposed, Outcome, Port, TICK_S};
use crate::search;

/// Largest speed of a simulated hand: just below the energy guard's limit of 60 rad/s, because the measured speed may be wrong by
/// an encoder count.
pub const FASTEST_RAD_PER_S: f64 = 59.0;

/// A type of simulated hand.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// A motion that repeats every ten control periods. The parts of a period before and after the change of force have their own
    /// speeds.
    Periodic,
    /// A sum of three sines below 200 Hz around a mean depth in the wall.
    Sines,
    /// A hand that reacts to the force at once: its speed before and after the change of force in a control period depends on the
    /// force and the force's change.
    Policy,
    /// A hand with mass that holds the device by a spring, and pushes.
    Gripped,
}

const PERIOD: usize = 10;

impl Way {
    /// All types of hand.
    pub const ALL: [Way; 4] = [Way::Periodic, Way::Sines, Way::Policy, Way::Gripped];

    /// Number of parameters that describe a hand of this type.
    #[must_use]
    pub fn dimensions(self) -> usize {
        match self {
            Way::Periodic => 2 * PERIOD + 2,
            Way::Sines => 10,
            Way::Policy => 2 * FEATURES + 2,
            Way::Gripped => 9,
        }
    }

    /// Simulates the hand with the parameters `numbers` for `ticks` control periods; returns how much energy it got out.
    #[must_use]
    pub fn play(self, port: &Port, numbers: &[f64], ticks: u32) -> Outcome {
        match self {
            Way::Periodic => port.play(&mut Periodic::new(port, numbers), ticks),
            Way::Sines => {
                let path = sines(numbers);
                port.play(&mut Imposed::new(path), ticks)
            }
            Way::Policy => port.play(&mut Policy::new(port, numbers), ticks),
            Way::Gripped => {
                let n = numbers.to_vec();
                let (f1, f2) = (frequency(n[0]), frequency(n[1]));
                let push = move |t: f64| {
                    0.1 * n[2]
                        + 0.3 * n[3] * (std::f64::consts::TAU * f1 * t).sin()
                        + 0.3 * n[4] * (std::f64::consts::TAU * f2 * t + n[5]).sin()
                };
                let mut hand = Gripped {
                    push,
                    inertia: 1e-4 * (2.0 * numbers[6]).clamp(-4.0, 4.0).exp(),
                    stiffness: 10.0 * (2.0 * numbers[7]).clamp(-5.0, 5.0).exp(),
                    grip_damping: 0.02 * (2.0 * numbers[8]).clamp(-6.0, 3.0).exp(),
                    knob: (0.0, 0.0),
                    hand: (0.0, 0.0),
                    time_s: 0.0,
                };
                port.play(&mut hand, ticks)
            }
        }
    }

    /// Searches for the worst hand of this type with this many evaluations. Returns its parameters, and the most energy in J that
    /// it got beyond the energy that refills the energy guard's account.
    #[must_use]
    pub fn worst(self, port: &Port, evaluations: u32, ticks: u32, seed: u64) -> (Vec<f64>, f64) {
        search::largest(self.dimensions(), 0.5, evaluations, seed, |numbers| {
            let taken = self.play(port, numbers, ticks).above_refill_j;
            if taken.is_finite() {
                taken
            } else {
                f64::NEG_INFINITY
            }
        })
    }
}

fn frequency(number: f64) -> f64 {
    20.0 * (1.2 * number).clamp(-3.0, 2.3).exp()
}

fn sines(n: &[f64]) -> impl Fn(f64) -> f64 + use<> {
    let parts: Vec<(f64, f64, f64)> = (0..3)
        .map(|i| {
            let omega = std::f64::consts::TAU * frequency(n[1 + 3 * i]);
            // The three sines together stay below the largest speed.
            let most = FASTEST_RAD_PER_S / 3.0 / omega;
            (
                (0.02 * n[2 + 3 * i]).clamp(-most, most),
                omega,
                n[3 + 3 * i],
            )
        })
        .collect();
    let depth = 0.01 * n[0];
    move |t| {
        let grown = (t / 0.1).min(1.0);
        let wave: f64 = parts.iter().map(|(a, w, p)| a * (w * t + p).sin()).sum();
        grown * (depth + wave)
    }
}

/// Limits a displacement in rad to what a hand can move in this time at [`FASTEST_RAD_PER_S`].
fn limited(wanted: f64, seconds: f64) -> f64 {
    let most = FASTEST_RAD_PER_S * seconds;
    wanted.clamp(-most, most)
}

struct Periodic {
    steps: Vec<f64>,
    at: f64,
    depth: f64,
}

impl Periodic {
    fn new(port: &Port, n: &[f64]) -> Self {
        let size = 0.003 * (2.0 * n[1]).clamp(-8.0, 3.0).exp();
        let seconds = |half: usize| {
            TICK_S
                * if half == 0 {
                    port.delay_ticks
                } else {
                    1.0 - port.delay_ticks
                }
        };
        let mut steps: Vec<f64> = (0..2 * PERIOD)
            .map(|i| limited(size * n[2 + i], seconds(i % 2)))
            .collect();
        // Subtracts the sum of the steps from all steps in proportion to their times, so that the motion returns to its start.
        // Then scales all steps down if one is too fast.
        let left: f64 = steps.iter().sum();
        for (i, step) in steps.iter_mut().enumerate() {
            *step -= left * seconds(i % 2) / (TICK_S * PERIOD as f64);
        }
        let fits = steps
            .iter()
            .enumerate()
            .map(|(i, step)| step.abs() / (FASTEST_RAD_PER_S * seconds(i % 2)).max(1e-12))
            .fold(1.0, f64::max);
        steps.iter_mut().for_each(|step| *step /= fits);
        Self {
            steps,
            at: 0.0,
            depth: 0.02 * n[0].abs(),
        }
    }
}

impl Hand for Periodic {
    fn start(&self) -> f64 {
        0.0
    }
    fn go(&mut self, tick: u32, late: bool, _: f64, seconds: f64) -> (f64, f64) {
        const ENTER: u32 = 50;
        let moved = if tick < ENTER {
            self.depth * seconds / (TICK_S * f64::from(ENTER))
        } else {
            let phase = (tick - ENTER) as usize % PERIOD;
            self.steps[2 * phase + usize::from(late)]
        };
        self.at += moved;
        (
            self.at,
            crate::port::DAMPING_N_M_S_PER_RAD * moved * moved / seconds,
        )
    }
}

const FEATURES: usize = 6;

struct Policy {
    weights: Vec<f64>,
    at: f64,
    before: f64,
    force: f64,
    change: f64,
    was_late: bool,
}

impl Policy {
    fn new(_: &Port, n: &[f64]) -> Self {
        Self {
            weights: n.to_vec(),
            at: 0.0,
            before: 0.0,
            force: 0.0,
            change: 0.0,
            was_late: false,
        }
    }
}

impl Hand for Policy {
    fn start(&self) -> f64 {
        0.0
    }
    fn go(&mut self, tick: u32, late: bool, force: f64, seconds: f64) -> (f64, f64) {
        // Updated once per tick, however many parts the tick has.
        if late && !self.was_late {
            self.change = force - self.force;
            self.force = force;
        }
        self.was_late = late;
        let n = &self.weights;
        let phase =
            std::f64::consts::TAU * frequency(n[2 * FEATURES + 1]) * f64::from(tick) * TICK_S;
        let features = [
            1.0,
            10.0 * self.force,
            30.0 * self.change,
            100.0 * self.at,
            300.0 * self.before,
            phase.sin(),
        ];
        let from = if late { FEATURES } else { 0 };
        let wish: f64 = features.iter().zip(&n[from..]).map(|(f, w)| f * w).sum();
        let size = FASTEST_RAD_PER_S * (2.0 * n[2 * FEATURES] - 3.0).clamp(-9.0, 0.0).exp();
        let moved = size * wish.tanh() * seconds;
        self.before = moved;
        self.at += moved;
        (
            self.at,
            crate::port::DAMPING_N_M_S_PER_RAD * moved * moved / seconds,
        )
    }
}
