//! The source of a law's position and velocity: the measured position, or a state estimator.

use crate::estimator::{Estimator, EstimatorState};
use crate::law::Sample;
use crate::{Force, Number, Position};

/// The stage before the control law, which gives the law the position and the displacement per tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum States<N: Number> {
    /// The measured penetration, and its change since the last tick.
    Measured {
        /// Penetration measured at the last tick.
        last: Position<N>,
    },
    /// A state estimator: penetration and velocity predicted for the time at which the force will act.
    Estimated(Estimator<N>, EstimatorState<N>),
}

impl<N: Number> Default for States<N> {
    fn default() -> Self {
        Self::Measured {
            last: Position::zero(),
        }
    }
}

impl<N: Number> States<N> {
    /// Returns the law's input, position and displacement, for a measured penetration.
    #[inline]
    pub fn sample(&mut self, e: Position<N>) -> Sample<N> {
        match self {
            Self::Measured { last } => {
                let sample = Sample::measured(e, *last);
                *last = e;
                sample
            }
            Self::Estimated(estimator, state) => estimator.tick(state, e),
        }
    }

    /// Clears the memory of the last position or of the estimator.
    pub fn forget(&mut self) {
        match self {
            Self::Measured { last } => *last = Position::zero(),
            Self::Estimated(_, state) => *state = EstimatorState::default(),
        }
    }

    /// Reports to the estimator the force that was commanded, as changed by all later stages.
    #[inline]
    pub fn commanded(&mut self, force: Force<N>) {
        if let Self::Estimated(estimator, state) = self {
            estimator.commanded(state, force);
        }
    }
}
