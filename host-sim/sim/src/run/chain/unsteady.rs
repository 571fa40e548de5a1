//! A hand with tremor, and a hand whose muscles react late (reflex).

use std::collections::VecDeque;

use touchstone_world::plant::Kinematics;

use super::crossing::{Crossing, Flow};

/// Changes the hand's rest point in each tick (control period), before plant and hand are advanced.
pub trait Unsteady<S>: Send {
    /// Returns the changed rest point of this tick, rad.
    fn rest_rad(&mut self, state: &S, rest_rad: f64) -> f64;
}

/// A crossing (path from torque command to plant) whose hand has a tremor or a reflex.
pub struct Handled<S, U> {
    inner: Box<dyn Crossing<State = S>>,
    hand: U,
}

impl<S: Kinematics + 'static, U: Unsteady<S> + 'static> Handled<S, U> {
    /// Adds a tremor or reflex of the hand to the crossing `inner`.
    #[must_use]
    pub fn before(inner: Box<dyn Crossing<State = S>>, hand: U) -> Box<dyn Crossing<State = S>> {
        Box::new(Self { inner, hand })
    }
}

impl<S: Kinematics, U: Unsteady<S>> Crossing for Handled<S, U> {
    type State = S;

    fn cross(&mut self, state: &mut S, torque_n_m: f64, rest_rad: f64) {
        let rest_rad = self.hand.rest_rad(state, rest_rad);
        self.inner.cross(state, torque_n_m, rest_rad);
    }

    fn cross_with_flow(&mut self, state: &mut S, torque_n_m: f64, rest_rad: f64) -> Flow {
        let rest_rad = self.hand.rest_rad(state, rest_rad);
        self.inner.cross_with_flow(state, torque_n_m, rest_rad)
    }

    fn changed_at_rad(&self) -> Option<f64> {
        self.inner.changed_at_rad()
    }
}

/// Tremor: a sine that is added to the hand's rest point.
#[derive(Debug, Clone, Copy)]
pub struct Tremor {
    /// Amplitude of the rest point's motion, rad.
    pub amplitude_rad: f64,
    /// Advance of the sine's phase per tick (control period), rad.
    pub per_tick_rad: f64,
    /// Number of ticks (control periods) since the start.
    pub tick: u64,
}

impl<S> Unsteady<S> for Tremor {
    fn rest_rad(&mut self, _: &S, rest_rad: f64) -> f64 {
        let swing = libm::sin(self.tick as f64 * self.per_tick_rad);
        self.tick += 1;
        rest_rad + self.amplitude_rad * swing
    }
}

/// A stretch reflex: muscles that answer an earlier stretch of the hand's spring with an additional stiffness `k_r`.
///
/// The rest point moves by `dr` so that the hand's spring `k_h` gives the muscles' torque: `k_h dr = -k_r (x_h - r)`. Hand angle
/// `x_h` and rest point `r` are those at the earlier time.
#[derive(Debug, Clone)]
pub struct Reflex {
    /// Gain `k_r/k_h`: stiffness of the reflex over that of the hand's spring.
    gain: f64,
    /// Stretches of the hand's spring that the muscles have not answered yet, rad, the oldest first.
    stretches: VecDeque<f64>,
}

impl Reflex {
    /// Makes a reflex that answers a stretch after `ticks` ticks (control periods).
    #[must_use]
    pub fn new(gain: f64, ticks: usize) -> Self {
        let mut stretches = VecDeque::with_capacity(ticks + 1);
        stretches.resize(ticks, 0.0);
        Self { gain, stretches }
    }
}

impl<S: Kinematics> Unsteady<S> for Reflex {
    fn rest_rad(&mut self, state: &S, rest_rad: f64) -> f64 {
        self.stretches.push_back(state.hand_position() - rest_rad);
        let stretch = self.stretches.pop_front().unwrap_or(0.0);
        rest_rad - self.gain * stretch
    }
}
