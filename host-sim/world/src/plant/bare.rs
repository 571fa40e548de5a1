//! A plant of a device without a hand and without dry friction.

use nalgebra::{SMatrix, matrix};

use super::device::{Device, Invalid, not_negative};
use super::flow::{apply, columns, flow_integral, quadratic, quadratic_integral, within_numbers};
use super::state::State;
use super::stepper::{LinearStepper, Loss, Stepper};

/// A device with inertia `J` and viscous damping `b` under a held torque `u`: `J dv/dt = u - b v`. The state is angle `x` and
/// velocity `v`.
///
/// The rest point of a hand is accepted but ignored, because there is no hand. Dry friction of the device is ignored.
#[derive(Debug, Clone, PartialEq)]
pub struct BareLinear {
    /// Increment of the state `[x, v]` (angle, velocity) in an interval, for each entry of `[v, u]` (velocity, torque).
    step: [[f64; 2]; 2],
    /// Matrix of the energy lost to viscous damping in an interval, J, as a quadratic form of `[v, u]` (velocity, torque).
    loss: [[f64; 2]; 2],
    pub(super) inertia: f64,
    pub(super) damping: f64,
    interval_s: f64,
}

impl BareLinear {
    /// Prepares steps of `interval_s` seconds (zero or more).
    ///
    /// # Errors
    /// [`Invalid`] when the device or the interval is out of range.
    pub fn new(device: &Device, interval_s: f64) -> Result<Self, Invalid> {
        device.validate()?;
        not_negative("interval_s", interval_s)?;
        let inertia = device.inertia;
        let damping = device.damping;
        let m = matrix![-damping / inertia, 1.0 / inertia; 0.0, 0.0];
        let rates = matrix![1.0, 0.0; -damping / inertia, 1.0 / inertia];
        let viscous: SMatrix<f64, 2, 2> = matrix![damping, 0.0; 0.0, 0.0];
        within_numbers(&m, interval_s)?;
        Ok(Self {
            step: columns(&(rates * flow_integral(&m, interval_s))),
            loss: columns(&quadratic_integral(&m, &viscous, interval_s)),
            inertia,
            damping,
            interval_s,
        })
    }

    /// Increment of angle and velocity in an interval under the constant torque `w`, N·m.
    #[inline(always)]
    pub(super) fn increment(&self, velocity: f64, w: f64) -> [f64; 2] {
        apply(&self.step, &[velocity, w])
    }

    /// Energy lost to viscous damping, `b ∫v² dt`, over an interval under the constant torque `w`, J. `b` is the damping, `v` the
    /// velocity.
    #[inline(always)]
    pub(super) fn viscous_loss(&self, velocity: f64, w: f64) -> f64 {
        quadratic(&self.loss, &[velocity, w])
    }
}

impl Stepper for BareLinear {
    type State = State<2>;

    fn interval_s(&self) -> f64 {
        self.interval_s
    }

    #[inline(always)]
    fn step(&self, state: &mut State<2>, force: f64, _rest: f64) {
        state.add(&self.increment(state.0[1], force));
    }

    #[inline]
    fn step_with_loss(&self, state: &mut State<2>, force: f64, rest: f64) -> Loss {
        let device_j = self.viscous_loss(state.0[1], force);
        self.step(state, force, rest);
        Loss {
            device_j,
            hand_j: 0.0,
        }
    }

    fn stored_energy_j(&self, state: &State<2>, _rest: f64) -> f64 {
        0.5 * self.inertia * state.0[1] * state.0[1]
    }
}

impl LinearStepper for BareLinear {}
