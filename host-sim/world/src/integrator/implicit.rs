//! Implicit Euler and implicit midpoint with set-valued friction: one step, at two points of the interval.

use super::{Method, Model, Reaction};
use crate::plant::flow::{apply, columns};
use crate::plant::{Invalid, Loss};

/// `z⁺ = z + h (A z⁺ + B w) - e₁ h λ/J` with `λ ∈ F Sgn(v⁺)`: first order, stable for every substep, and a device that friction
/// holds stays bit for bit (Kikuuwe, Takesue, Sano, Mochiyama and Fujimoto, IEEE T-RO 22(6) 1176, 2006; Acary and Brogliato, Systems
/// & Control Letters 59(5) 284, 2010).
pub type ImplicitEuler<const N: usize> = Implicit<N, false>;

/// `z⁺ = z + h (A (z + z⁺)/2 + B w) - e₁ h λ/J` with `λ ∈ F Sgn(v⁺)`: second order, keeps the energy balance to rounding, and rings
/// on poles that are fast against the substep.
///
/// Friction is implicit at the end of the step (the theta scheme of Moreau's stepping): at the middle it would hold the position
/// while the velocity changes its sign at every substep.
pub type ImplicitMidpoint<const N: usize> = Implicit<N, true>;

/// The implicit step with its rates at the substep's end, or at its `MIDDLE`.
#[derive(Debug, Clone, PartialEq)]
pub struct Implicit<const N: usize, const MIDDLE: bool> {
    /// `h (I - θ h A)⁻¹`, with `θ` 1 at the end and 1/2 at the middle.
    step: [[f64; N]; N],
    /// Change of the state per torque of friction.
    response: [f64; N],
    step_s: f64,
}

impl<const N: usize, const MIDDLE: bool> Method<N> for Implicit<N, MIDDLE> {
    const ORDER: u32 = if MIDDLE { 2 } else { 1 };

    fn new(model: &Model<N>, step_s: f64) -> Result<Self, Invalid> {
        let inverse = model.resolvent(if MIDDLE { 0.5 * step_s } else { step_s })?;
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
                state[0] = before[0];
                if MIDDLE {
                    state[0] += 0.5 * self.step_s * before[1];
                }
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
        let at = if MIDDLE {
            std::array::from_fn(|i| 0.5 * (before[i] + state[i]))
        } else {
            *state
        };
        super::losses(model, &at, torque, self.step_s)
    }
}
