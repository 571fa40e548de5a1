//! Implicit Euler with set-valued friction.

use super::{Method, Model, Reaction};
use crate::plant::flow::{apply, columns};
use crate::plant::{Invalid, Loss};

/// `z⁺ = z + h (A z⁺ + B w) - e₁ h λ/J` with `λ ∈ F Sgn(v⁺)`: first order, stable for every substep, and a device that friction
/// holds stays bit for bit (Kikuuwe, Takesue, Sano, Mochiyama and Fujimoto, IEEE T-RO 22(6) 1176, 2006; Acary and Brogliato, Systems
/// & Control Letters 59(5) 284, 2010).
#[derive(Debug, Clone, PartialEq)]
pub struct ImplicitEuler<const N: usize> {
    /// `h (I - h A)⁻¹`.
    step: [[f64; N]; N],
    /// Change of the state per torque of friction.
    response: [f64; N],
    step_s: f64,
}

impl<const N: usize> Method<N> for ImplicitEuler<N> {
    const ORDER: u32 = 1;

    fn new(model: &Model<N>, step_s: f64) -> Result<Self, Invalid> {
        let inverse = model.resolvent(step_s)?;
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
                (state[0], state[1]) = (before[0], 0.0);
            }
        } else {
            for i in 0..N {
                state[i] += increment[i];
            }
        }
        if !LOSS {
            return Loss::default();
        }
        let Loss { device_j, hand_j } = model.viscous(state);
        Loss {
            device_j: self.step_s * (device_j + torque * state[1]),
            hand_j: self.step_s * hand_j,
        }
    }
}
