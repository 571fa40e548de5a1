//! The classical Runge–Kutta method of fourth order, with smoothed friction.

use super::{Method, Model};
use crate::plant::{Invalid, Loss};

/// Velocity at which the smoothed friction has three quarters of its full value, rad/s. A device that should rest creeps at a
/// velocity below it.
pub const CREEP_RAD_PER_S: f64 = 1e-3;

/// The classical Runge–Kutta method: four evaluations per substep, fourth order. It is stable while the substep is shorter than
/// 2.785 time constants of the fastest pole.
///
/// It needs a derivative everywhere, so friction is `F_k tanh(v/v_s)` with [`CREEP_RAD_PER_S`] as `v_s`. This is another model of
/// friction, without break-away torque and without rest; no substep is short enough to remove its error.
#[derive(Debug, Clone, PartialEq)]
pub struct RungeKutta4<const N: usize> {
    step_s: f64,
}

/// Time derivative of the state, and the power of the losses.
struct Slope<const N: usize> {
    rate: [f64; N],
    loss: Loss,
}

fn slope<const LOSS: bool, const N: usize>(
    model: &Model<N>,
    state: &[f64; N],
    held: [f64; 2],
) -> Slope<N> {
    let mut rate = model.rate(state, held);
    let mut loss = if LOSS {
        model.viscous(state)
    } else {
        Loss::default()
    };
    if let Some(coulomb) = model.friction() {
        let torque = coulomb.kinetic * libm::tanh(state[1] / CREEP_RAD_PER_S);
        rate[1] -= torque / model.inertia();
        loss.device_j += torque * state[1];
    }
    Slope { rate, loss }
}

impl<const N: usize> Method<N> for RungeKutta4<N> {
    const ORDER: u32 = 4;

    fn new(_: &Model<N>, step_s: f64) -> Result<Self, Invalid> {
        Ok(Self { step_s })
    }

    #[inline]
    fn step<const LOSS: bool>(
        &self,
        model: &Model<N>,
        state: &mut [f64; N],
        held: [f64; 2],
    ) -> Loss {
        let before = *state;
        let at = |slope: &Slope<N>, share: f64| -> [f64; N] {
            std::array::from_fn(|i| before[i] + share * self.step_s * slope.rate[i])
        };
        let first = slope::<LOSS, N>(model, &before, held);
        let second = slope::<LOSS, N>(model, &at(&first, 0.5), held);
        let third = slope::<LOSS, N>(model, &at(&second, 0.5), held);
        let fourth = slope::<LOSS, N>(model, &at(&third, 1.0), held);
        let sixth = self.step_s / 6.0;
        for (i, entry) in state.iter_mut().enumerate() {
            *entry +=
                sixth * (first.rate[i] + 2.0 * (second.rate[i] + third.rate[i]) + fourth.rate[i]);
        }
        let sum = |part: fn(&Loss) -> f64| {
            let inner = part(&second.loss) + part(&third.loss);
            sixth * (part(&first.loss) + 2.0 * inner + part(&fourth.loss))
        };
        Loss {
            device_j: sum(|loss| loss.device_j),
            hand_j: sum(|loss| loss.hand_j),
        }
    }
}
