//! Predicts position and displacement of the hand's point (HIP) for the time at which the next force acts: a state estimator for
//! each Cartesian axis.
//!
//! The estimators work along the axes of space and not along the normal, because along the axes the model is linear for any object:
//! `M dv/dt = F - b v + M h` with mass `M`, velocity `v`, force `F`, damping `b`, and the hand's push `h` as an acceleration. Along
//! a normal that turns with radius `R`, the depth would accelerate by `v²/R` without any force. The commands that are not yet in
//! effect would have to be turned too. When the HIP goes from one face to another, the state would change its coordinate.
//! `docs/three-axes.md` compares the two choices.
//!
//! Each axis uses [`crate::Estimator`] unchanged, with `-x` for its penetration, so that a force along `x` pushes out. So for a
//! plane through the origin and perpendicular to an axis, a three-axis wall on estimated states gives the same force as the
//! one-axis wall, bit for bit.

use super::number::Spatial;
use super::vector::Vector;
use crate::estimator::{Estimator, EstimatorState};
use crate::{Force, Position};

/// The predicted state of the hand's point (HIP), which the laws use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceAhead<N: Spatial> {
    /// Predicted position of the hand's point (HIP).
    pub at: Vector<Position<N>>,
    /// Predicted displacement of the hand's point (HIP) per tick.
    pub moved: Vector<Position<N>>,
}

/// A state estimator for each axis, with its memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceEstimator<N: Spatial> {
    axes: [(Estimator<N>, EstimatorState<N>); 3],
}

impl<N: Spatial> PlaceEstimator<N> {
    /// The estimator before the first sample. The coefficients must be in the unit of length that the device uses:
    /// [`super::LengthUnit::estimator`].
    #[must_use]
    pub fn new(axes: [Estimator<N>; 3]) -> Self {
        Self {
            axes: axes.map(|estimator| (estimator, EstimatorState::default())),
        }
    }

    /// Runs one control period: takes a measured position, returns position and displacement for the time at which the next command
    /// begins to act. The caller must call [`PlaceEstimator::commanded`] next.
    #[inline]
    pub fn tick(&mut self, measured: Vector<Position<N>>) -> PlaceAhead<N> {
        let mut ahead = PlaceAhead {
            at: Vector::default(),
            moved: Vector::default(),
        };
        let out = ahead.at.0.iter_mut().zip(&mut ahead.moved.0);
        let axes = self.axes.iter_mut().zip(measured.reversed().0);
        for ((at, moved), ((estimator, state), e)) in out.zip(axes) {
            let sample = estimator.tick(state, e);
            (*at, *moved) = (sample.e, sample.moved);
        }
        PlaceAhead {
            at: ahead.at.reversed(),
            moved: ahead.moved.reversed(),
        }
    }

    /// Reports the force on the hand's point (HIP) that was commanded after a tick, as changed by all later stages.
    #[inline]
    pub fn commanded(&mut self, force: Vector<Force<N>>) {
        for ((estimator, state), force) in self.axes.iter_mut().zip(force.0) {
            estimator.commanded(state, force);
        }
    }
}
