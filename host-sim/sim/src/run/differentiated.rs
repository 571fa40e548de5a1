//! A wall whose spring with damping takes its velocity from a [`Differentiator`]: a rival from the literature, in the simulator alone.

use super::differentiator::Differentiator;
use super::wall::{Controlled, Inside, Wall};
use touchstone_control::law::Sample;
use touchstone_control::{Position, Reported};

/// A law on velocities of another kind than the difference of two positions.
#[derive(Debug, Clone)]
pub struct Differentiated<N: Reported> {
    /// The law, which would take that difference.
    pub controlled: Controlled<N>,
    /// What it takes in its place.
    pub differentiator: Differentiator,
    /// A tick, s.
    pub period_s: f64,
}

impl<N: Reported> Differentiated<N> {
    fn force_n_m(&mut self, e: Position<N>) -> f64 {
        let velocity = self.differentiator.rad_per_s(e.to_f64());
        let moved = Position::from_f64(velocity * self.period_s);
        self.controlled.told(Sample { e, moved }, e).to_f64()
    }
}

impl<N: Reported> Wall for Differentiated<N> {
    fn at_count(&mut self, count: i64) -> f64 {
        let e = self.controlled.penetration(count);
        self.force_n_m(e)
    }

    fn at_penetration(&mut self, penetration_rad: f64) -> f64 {
        self.force_n_m(Position::from_f64(penetration_rad))
    }

    fn commanded(&mut self, force_n_m: f64) {
        self.controlled.commanded(force_n_m);
    }

    fn changed_at_count(&mut self, count: i64) {
        self.controlled.changed_at_count(count);
    }

    fn changed_at_penetration(&mut self, penetration_rad: f64) {
        self.controlled.changed_at_penetration(penetration_rad);
    }

    fn inside(&self) -> Inside {
        self.controlled.inside()
    }
}
