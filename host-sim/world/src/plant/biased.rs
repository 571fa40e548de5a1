//! Dry friction that is greater in one direction than in the other.

use super::device::Invalid;
use super::state::State;
use super::stepper::{Loss, Stepper};

/// A plant whose dry friction differs by direction: larger by `bias` against positive motion, smaller by `bias` against negative
/// motion, at rest and in motion.
///
/// The motion is computed as that of the plant with symmetric friction (`F` in motion, `F_s` at rest) under the torque
/// `u - bias`. In positive motion the torque left is then `u - (F + bias)`, in negative motion `u + (F - bias)`. The device rests
/// while `-(F_s - bias) <= u <= F_s + bias`. The result is as exact as that of the wrapped plant. The work of the bias counts as
/// dissipated, because the bias is friction and not a motor.
pub struct Biased<const N: usize> {
    inner: Box<dyn Stepper<State = State<N>>>,
    bias: f64,
}

impl<const N: usize> Biased<N> {
    /// Wraps a plant with symmetric friction; `kinetic` is its friction torque in motion, N·m.
    ///
    /// # Errors
    /// [`Invalid`] for a bias so large that friction would drive the device.
    pub fn new(
        inner: impl Stepper<State = State<N>> + 'static,
        kinetic: f64,
        bias: f64,
    ) -> Result<Self, Invalid> {
        if bias.abs() <= kinetic {
            Ok(Self {
                inner: Box::new(inner),
                bias,
            })
        } else {
            Err(Invalid {
                field: "asymmetry",
                value: bias,
                needs: "at most the kinetic friction",
            })
        }
    }
}

impl<const N: usize> Stepper for Biased<N> {
    type State = State<N>;

    fn interval_s(&self) -> f64 {
        self.inner.interval_s()
    }

    fn step(&self, state: &mut State<N>, force: f64, rest: f64) {
        self.inner.step(state, force - self.bias, rest);
    }

    fn step_with_loss(&self, state: &mut State<N>, force: f64, rest: f64) -> Loss {
        let before = state.0[0];
        let mut loss = self.inner.step_with_loss(state, force - self.bias, rest);
        loss.device_j += self.bias * (state.0[0] - before);
        loss
    }

    fn stored_energy_j(&self, state: &State<N>, rest: f64) -> f64 {
        self.inner.stored_energy_j(state, rest)
    }
}
