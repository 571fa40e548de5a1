//! The classical Runge–Kutta method of fourth order, with smoothed friction.

use super::{Method, Model};
use crate::plant::{Invalid, Loss};

/// Velocity `v_s` at which the smoothed friction has three quarters of its full torque, rad/s. A device that dry friction should
/// hold under a torque `u` creeps at `v_s atanh(u/F_k)`, with the friction torque `F_k` in motion.
pub const CREEP_RAD_PER_S: f64 = 1e-3;

/// The classical Runge–Kutta method of fourth order, with four evaluations per substep. It is stable while the substep is shorter
/// than 2.785 time constants of the fastest pole.
///
/// The method needs a derivative everywhere, so dry friction is smoothed to `F_k tanh(v/v_s)`. `F_k` is the friction torque in
/// motion, `v` the device's velocity, and `v_s` is [`CREEP_RAD_PER_S`]. Smoothed friction has no break-away torque and no rest; no
/// substep is short enough to remove this error.
#[derive(Debug, Clone, PartialEq)]
pub struct RungeKutta4<const N: usize> {
    step_s: f64,
}

/// Time derivative of the state, and the dissipated power in W.
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
