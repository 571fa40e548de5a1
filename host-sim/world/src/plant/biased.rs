//! Dry friction that is greater in one direction than in the other.

use super::device::Invalid;
use super::state::State;
use super::stepper::{Loss, Stepper};

/// A plant whose dry friction is larger by `bias` against positive motion and smaller by `bias` against negative motion, at rest
/// and in motion.
///
/// It is the plant with equal friction under the torque `u - bias`. In motion the torque is `u - (F + bias)` or `u + (F - bias)`.
/// Rest lasts while `-(F_s - bias) <= u <= F_s + bias`. So it is as exact as that plant. The bias is friction and not a motor: its
/// work is dissipated.
pub struct Biased<const N: usize> {
    inner: Box<dyn Stepper<State = State<N>>>,
    bias: f64,
}

impl<const N: usize> Biased<N> {
    /// Wraps a plant with equal friction; `kinetic` is its friction in motion.
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
