//! Jitter and random latency: position samples and torque commands that come late by random times.

use std::collections::VecDeque;

use touchstone_world::plant::{Kinematics as _, Stepper};

use super::crossing::{Crossing, Flow, step_with_flow};
use super::noise::Stream;

/// Number of equal parts of a control period. Delay and lateness are whole numbers of parts. The number is a power of two,
/// because the steppers span 1, 2, 4, … parts.
pub const PARTS: u32 = 1 << DOUBLINGS;
const DOUBLINGS: u32 = 10;

/// Delays every position sample by up to `jitter`, and every torque command by `delay` to `delay + spread`.
///
/// Each random delay is uniformly distributed, in whole parts ([`PARTS`]) of a control period. Commands keep their order. A tick
/// lasts from one sample to the next, so it may be longer or shorter than a control period. Records give the nominal time of a
/// sample, and the hand's rest point is that of the nominal time.
#[derive(Debug, Clone)]
pub struct Irregular<S> {
    /// Steppers that advance the plant over 1, 2, 4, … parts of a control period.
    steppers: Vec<S>,
    /// Delayed commands, the oldest first: parts of a control period from the present sample to the command's effect, and torque in
    /// N·m.
    queue: VecDeque<(u64, f64)>,
    acting_n_m: f64,
    delay: u64,
    jitter: u64,
    spread: u64,
    jitters: Stream,
    latencies: Stream,
    /// Lateness of the present sample, in parts of a control period.
    late: u64,
    changed_at_rad: Option<f64>,
}

/// Delay and largest random lateness, in parts of a control period.
#[derive(Debug, Clone, Copy)]
pub struct Lateness {
    /// Least time from a position sample to its torque command.
    pub delay: u64,
    /// Largest lateness of a position sample.
    pub jitter: u64,
    /// Largest additional delay of a torque command.
    pub spread: u64,
}

impl<S: Stepper> Irregular<S> {
    /// Builds a crossing with random lateness. `plant` makes a stepper that advances the plant by a time in s.
    ///
    /// # Errors
    /// Settings that `plant` refuses.
    pub fn new<E>(
        plant: impl Fn(f64) -> Result<S, E>,
        period_s: f64,
        lateness: Lateness,
        streams: [Stream; 2],
    ) -> Result<Self, E> {
        let part = |doublings: u32| period_s / f64::from(PARTS >> doublings);
        let steppers = (0..=DOUBLINGS)
            .map(|doublings| plant(part(doublings)))
            .collect::<Result<_, E>>()?;
        let longest = lateness.delay + lateness.spread + lateness.jitter;
        let [jitters, latencies] = streams;
        Ok(Self {
            steppers,
            // Capacity for all commands that can be delayed at a time, so that no tick allocates memory.
            queue: VecDeque::with_capacity((longest / u64::from(PARTS)) as usize + 4),
            acting_n_m: 0.0,
            delay: lateness.delay,
            jitter: lateness.jitter,
            spread: lateness.spread,
            jitters,
            latencies,
            late: 0,
            changed_at_rad: None,
        })
    }

    /// Makes the crossing also measure the angle of the device when the torque changes.
    #[must_use]
    pub fn measured(self, start_rad: f64) -> Self {
        Self {
            changed_at_rad: Some(start_rad),
            ..self
        }
    }

    /// Draws a random number of parts, from 0 to `most`.
    fn drawn(stream: &mut Stream, most: u64) -> u64 {
        (stream.uniform() * (most + 1) as f64) as u64
    }

    /// Queues a torque command, and returns the number of parts of a control period until the next sample.
    fn take(&mut self, torque_n_m: f64) -> u64 {
        let after = self.delay + Self::drawn(&mut self.latencies, self.spread);
        let latest = self.queue.back().map_or(0, |&(at, _)| at);
        self.queue.push_back((after.max(latest), torque_n_m));
        let late = Self::drawn(&mut self.jitters, self.jitter);
        let parts = u64::from(PARTS) + late - self.late;
        self.late = late;
        parts
    }

    /// Advances one tick. Calls `step` for every stretch of constant torque that one stepper can span.
    #[inline(always)]
    fn tick(
        &mut self,
        state: &mut S::State,
        torque_n_m: f64,
        mut step: impl FnMut(&S, &mut S::State, f64),
    ) {
        let parts = self.take(torque_n_m);
        let mut now = 0;
        loop {
            while let Some(&(at, torque)) = self.queue.front()
                && at <= now
            {
                self.acting_n_m = torque;
                self.queue.pop_front();
                if let Some(changed) = &mut self.changed_at_rad {
                    *changed = state.position();
                }
            }
            if now >= parts {
                break;
            }
            let until = self.queue.front().map_or(parts, |&(at, _)| at.min(parts));
            while now < until {
                let doublings = (until - now).ilog2().min(DOUBLINGS);
                step(&self.steppers[doublings as usize], state, self.acting_n_m);
                now += 1 << doublings;
            }
        }
        for (at, _) in &mut self.queue {
            *at -= parts;
        }
    }
}

impl<S: Stepper> Crossing for Irregular<S> {
    type State = S::State;

    fn cross(&mut self, state: &mut S::State, torque_n_m: f64, rest_rad: f64) {
        self.tick(state, torque_n_m, |plant, state, torque| {
            plant.step(state, torque, rest_rad);
        });
    }

    fn cross_with_flow(&mut self, state: &mut S::State, torque_n_m: f64, rest_rad: f64) -> Flow {
        let mut sum = Flow::default();
        let mut impulse = 0.0;
        let mut time_s = 0.0;
        self.tick(state, torque_n_m, |plant, state, torque| {
            let flow = step_with_flow(plant, state, torque, rest_rad);
            impulse += flow.torque_n_m * plant.interval_s();
            time_s += plant.interval_s();
            sum.motor_j += flow.motor_j;
            sum.device_loss_j += flow.device_loss_j;
            sum.stored_j += flow.stored_j;
        });
        // If two samples coincide, the tick between them has no duration; its mean torque is then the torque that acts.
        sum.torque_n_m = if time_s > 0.0 {
            impulse / time_s
        } else {
            self.acting_n_m
        };
        sum
    }

    fn changed_at_rad(&self) -> Option<f64> {
        self.changed_at_rad
    }
}
