//! The implicit Euler and implicit midpoint methods. Dry friction is set-valued: at rest it takes any value up to its limit. The
//! two methods differ in where they evaluate the rates: at the end or in the middle of the substep.

use super::{Method, Model, Reaction};
use crate::plant::flow::{apply, columns};
use crate::plant::{Invalid, Loss};

/// Implicit Euler: `z⁺ = z + h (A z⁺ + B w) - e₁ h λ/J` with the friction torque `λ ∈ F Sgn(v⁺)`.
///
/// `z` is the state before a substep of length `h` and `z⁺` the state after it. `A` and `B` are the matrices of the linear model,
/// `w` its held inputs. Row `e₁` is that of the device's velocity `v`; `J` is the device's inertia and `F` the friction torque in
/// motion.
///
/// The method is of first order and stable for every `h`. A device that friction holds keeps its position bit for bit (Kikuuwe,
/// Takesue, Sano, Mochiyama and Fujimoto, IEEE T-RO 22(6) 1176, 2006; Acary and Brogliato, Systems & Control Letters 59(5) 284,
/// 2010).
pub type ImplicitEuler<const N: usize> = Implicit<N, false>;

/// Implicit midpoint: `z⁺ = z + h (A (z + z⁺)/2 + B w) - e₁ h λ/J` with the friction torque `λ ∈ F Sgn(v⁺)`. Symbols as for
/// [`ImplicitEuler`].
///
/// The method is of second order, and its energy balance closes to rounding. The solution rings if a pole is fast compared with the
/// substep `h`.
///
/// Friction is evaluated at the end of the step (the theta scheme of Moreau's stepping). Evaluated in the middle of the step,
/// friction would hold the position while the velocity changes its sign at every substep.
pub type ImplicitMidpoint<const N: usize> = Implicit<N, true>;

/// An implicit integration step. It evaluates the rates in the middle of the substep if `MIDDLE` is true, else at its end.
#[derive(Debug, Clone, PartialEq)]
pub struct Implicit<const N: usize, const MIDDLE: bool> {
    /// The matrix `h (I - θ h A)⁻¹`, with the substep's length `h` and the model's matrix `A`. `θ` is 1 for rates at the substep's
    /// end, 1/2 for rates in its middle.
    step: [[f64; N]; N],
    /// Change of the state in a substep per unit of friction torque, 1/(N·m).
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
