//! Runs an integration method over the substeps of an interval, with the interface of a plant in closed form.

use super::{Method, Model};
use crate::plant::device::not_negative;
use crate::plant::{Invalid, Loss, State, Stepper};

/// A plant that advances by one interval in equal substeps of an integration method.
#[derive(Debug, Clone, PartialEq)]
pub struct Substepped<M, const N: usize> {
    model: Model<N>,
    method: Option<M>,
    substeps: u32,
    interval_s: f64,
}

impl<M: Method<N>, const N: usize> Substepped<M, N> {
    /// Prepares intervals of `interval_s` seconds (zero or more), each divided into `substeps` substeps (1 or more).
    ///
    /// # Errors
    /// [`Invalid`] when the interval is out of range or the method cannot make a step of this length.
    pub fn new(model: &Model<N>, interval_s: f64, substeps: u32) -> Result<Self, Invalid> {
        not_negative("interval_s", interval_s)?;
        let substeps = substeps.max(1);
        // An interval of zero length has no substep, so nothing moves.
        let method = (interval_s > 0.0)
            .then(|| M::new(model, interval_s / f64::from(substeps)))
            .transpose()?;
        Ok(Self {
            model: model.clone(),
            method,
            substeps,
            interval_s,
        })
    }

    /// Advances the state by one interval under held inputs (torque, rest point). Computes the losses only if `LOSS` is true.
    #[inline]
    pub fn advance<const LOSS: bool>(&self, state: &mut [f64; N], held: [f64; 2]) -> Loss {
        let mut loss = Loss::default();
        if let Some(method) = &self.method {
            for _ in 0..self.substeps {
                loss += method.step::<LOSS>(&self.model, state, held);
            }
        }
        loss
    }
}

impl<M: Method<N>, const N: usize> Stepper for Substepped<M, N> {
    type State = State<N>;

    fn interval_s(&self) -> f64 {
        self.interval_s
    }

    #[inline]
    fn step(&self, state: &mut State<N>, force: f64, rest: f64) {
        let mut entries = state.to_array();
        self.advance::<false>(&mut entries, [force, rest]);
        *state = State::from_array(entries);
    }

    #[inline]
    fn step_with_loss(&self, state: &mut State<N>, force: f64, rest: f64) -> Loss {
        let mut entries = state.to_array();
        let loss = self.advance::<true>(&mut entries, [force, rest]);
        *state = State::from_array(entries);
        loss
    }

    fn stored_energy_j(&self, state: &State<N>, rest: f64) -> f64 {
        self.model.stored_energy_j(&state.to_array(), rest)
    }
}
