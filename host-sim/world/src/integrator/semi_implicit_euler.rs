//! The semi-implicit (symplectic) Euler method.

use super::{Method, Model, Reaction};
use crate::plant::{Invalid, Loss};

/// Semi-implicit Euler: computes the new velocities from the forces at the start of the substep, then the new positions from the
/// new velocities.
///
/// The method is of first order, with one evaluation per substep. It is stable only while the substep is short compared with the
/// time constant of every pole. Friction takes at most the torque that stops the device.
#[derive(Debug, Clone, PartialEq)]
pub struct SemiImplicitEuler<const N: usize> {
    positions: [bool; N],
    /// Change of the device's velocity in a substep per friction torque, rad/s per N·m.
    response: f64,
    step_s: f64,
}

impl<const N: usize> Method<N> for SemiImplicitEuler<N> {
    const ORDER: u32 = 1;

    fn new(model: &Model<N>, step_s: f64) -> Result<Self, Invalid> {
        Ok(Self {
            positions: model.positions(),
            response: step_s / model.inertia(),
            step_s,
        })
    }

    #[inline]
    fn step<const LOSS: bool>(
        &self,
        model: &Model<N>,
        state: &mut [f64; N],
        held: [f64; 2],
    ) -> Loss {
        let before = state[1];
        let rate = model.rate(state, held);
        for i in 0..N {
            if !self.positions[i] {
                state[i] += self.step_s * rate[i];
            }
        }
        let mut torque = 0.0;
        if let Some(coulomb) = model.friction() {
            let reaction = Reaction::of(coulomb, before, state[1], self.response);
            torque = reaction.torque();
            state[1] = match reaction {
                Reaction::Rests(_) => 0.0,
                Reaction::Slides(torque) => state[1] - torque * self.response,
            };
        }
        // The entry after a position is its velocity.
        for i in 0..N {
            if self.positions[i] {
                state[i] += self.step_s * state[i + 1];
            }
        }
        if !LOSS {
            return Loss::default();
        }
        super::losses(model, state, torque, self.step_s)
    }
}
