//! Implicit midpoint with set-valued friction at the end of the step.

use super::{Method, Model, Reaction};
use crate::plant::flow::{apply, columns};
use crate::plant::{Invalid, Loss};

/// `z⁺ = z + h (A (z + z⁺)/2 + B w) - e₁ h λ/J` with `λ ∈ F Sgn(v⁺)`: second order, keeps the energy's books to rounding, and rings
/// on poles that are fast against the substep.
///
/// Friction is implicit at the end of the step (the theta scheme of Moreau's stepping): at the middle it would hold the position
/// while the velocity changes its sign at every substep.
#[derive(Debug, Clone, PartialEq)]
pub struct ImplicitMidpoint<const N: usize> {
    /// `h (I - h/2 A)⁻¹`.
    step: [[f64; N]; N],
    /// Change of the state per torque of friction.
    response: [f64; N],
    step_s: f64,
}

impl<const N: usize> Method<N> for ImplicitMidpoint<N> {
    const ORDER: u32 = 2;

    fn new(model: &Model<N>, step_s: f64) -> Result<Self, Invalid> {
        let inverse = model.resolvent(0.5 * step_s)?;
        Ok(Self {
            step: columns(&(inverse * step_s)),
            response: std::array::from_fn(|i| inverse[(i, 1)] * step_s / model.inertia()),
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
        let before = *state;
        let increment = apply(&self.step, &model.rate(&before, held));
        let mut torque = 0.0;
        if let Some(coulomb) = model.friction() {
            let free = before[1] + increment[1];
            let reaction = Reaction::of(coulomb, before[1], free, self.response[1]);
            torque = reaction.torque();
            for i in 0..N {
                state[i] += increment[i] - torque * self.response[i];
            }
            if let Reaction::Rests(_) = reaction {
                state[0] = before[0] + 0.5 * self.step_s * before[1];
                state[1] = 0.0;
            }
        } else {
            for i in 0..N {
                state[i] += increment[i];
            }
        }
        if !LOSS {
            return Loss::default();
        }
        let middle = std::array::from_fn(|i| 0.5 * (before[i] + state[i]));
        let Loss { device_j, hand_j } = model.viscous(&middle);
        Loss {
            device_j: self.step_s * (device_j + torque * middle[1]),
            hand_j: self.step_s * hand_j,
        }
    }
}
