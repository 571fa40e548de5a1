//! A linear phase of a control law as matrices, from which every certificate is computed.

use super::estimator::Estimator;
use super::state_space::StateSpace;
use nalgebra::{DMatrix, DVector};

/// A control law in a linear phase: `s' = a s + b [e, m]`, `f = c s + d [e, m]`, one step per control period. `s` is the state, `e`
/// the penetration, `m` the displacement per period and `f` the force.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearLaw {
    /// Matrix from the state to the next state.
    pub a: DMatrix<f64>,
    /// Matrix from penetration and displacement to the next state.
    pub b: DMatrix<f64>,
    /// Vector from the state to the force.
    pub c: DVector<f64>,
    /// Factors from penetration and displacement to the force of the same tick.
    pub d: [f64; 2],
}

impl LinearLaw {
    /// Interpolates between two laws that differ in one gain: returns `from` for a `share` of 0, `to` for a `share` of 1.
    #[must_use]
    pub fn between(from: &Self, to: &Self, share: f64) -> Self {
        let mix = |a: f64, b: f64| a + share * (b - a);
        Self {
            a: from.a.zip_map(&to.a, mix),
            b: from.b.zip_map(&to.b, mix),
            c: from.c.zip_map(&to.c, mix),
            d: [mix(from.d[0], to.d[0]), mix(from.d[1], to.d[1])],
        }
    }

    /// Builds the matrices from a function. `step` gets state, penetration and displacement, changes the state and returns the
    /// force; it must be linear.
    #[must_use]
    pub fn of(order: usize, step: impl Fn(&mut [f64], f64, f64) -> f64) -> Self {
        let by_penetration = StateSpace::of(order, |state, e| step(state, e, 0.0));
        let by_displacement = StateSpace::of(order, |state, moved| step(state, 0.0, moved));
        Self {
            b: DMatrix::from_columns(&[by_penetration.b, by_displacement.b]),
            d: [by_penetration.d, by_displacement.d],
            a: by_penetration.a,
            c: by_penetration.c,
        }
    }

    /// The law spring-damper, from stiffness in N·m/rad and damping force per displacement in a control period, N·m/rad.
    #[must_use]
    pub fn spring(stiffness: f64, damping_per_tick: f64) -> Self {
        Self::of(0, |_, e, moved| stiffness * e + damping_per_tick * moved)
    }

    /// Number of state variables.
    #[must_use]
    pub fn order(&self) -> usize {
        self.c.len()
    }

    fn answer(&self, state: &mut [f64], e: f64, moved: f64) -> f64 {
        let inputs = [e, moved];
        let force = state
            .iter()
            .zip(self.c.iter())
            .map(|(s, c)| s * c)
            .sum::<f64>()
            + self.d[0] * e
            + self.d[1] * moved;
        let next: Vec<f64> = (0..self.order())
            .map(|row| {
                let own: f64 = (0..self.order())
                    .map(|column| self.a[(row, column)] * state[column])
                    .sum();
                own + self.b[(row, 0)] * inputs[0] + self.b[(row, 1)] * inputs[1]
            })
            .collect();
        state.copy_from_slice(&next);
        force
    }

    /// The law with measured penetrations, as a system from position to force. The displacement is the difference from the last
    /// sample, which is an additional state, the last one.
    #[must_use]
    pub fn on_measured(&self) -> StateSpace {
        let order = self.order();
        StateSpace::of(order + 1, |state, e| {
            let (own, last) = state.split_at_mut(order);
            let force = self.answer(own, e, e - last[0]);
            last[0] = e;
            force
        })
    }

    /// The law with estimated states, as a system from position to force. The law's states come first, then the estimator's.
    #[must_use]
    pub fn on_estimated(&self, estimator: &Estimator) -> StateSpace {
        let order = self.order();
        StateSpace::of(order + Estimator::ORDER, |state, measured| {
            let (own, estimate) = state.split_at_mut(order);
            let told = estimator.update(estimate, measured);
            let force = self.answer(own, told.e.0, told.moved.0);
            estimator.command(estimate, force);
            force
        })
    }
}

/// A linear phase of a control law: a mode of operation in which the law is linear.
#[derive(Debug, Clone, PartialEq)]
pub struct Phase {
    /// Name of the phase in a certificate.
    pub name: &'static str,
    /// Matrices of the control law in this phase.
    pub law: LinearLaw,
}
