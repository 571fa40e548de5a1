//! Where the HIP will be when the next force acts, and how it moves: a state estimator along each Cartesian axis.
//!
//! Along the axes of space and not along the normal, since that is where the model is linear: `M dv/dt = F - b v + M h` is the same
//! whatever object is touched. Along a normal that turns, depth and velocity would change without any force, by `v²/R`, and the
//! commands on their way would have to be turned with it. Where the HIP leaves one face for another, the state would be that of another coordinate.
//! `docs/three-axes.md` has both choices.
//!
//! Each axis is [`crate::Estimator`] as it stands, told `-x` for its penetration, so that a force along `x` is one that pushes out.
//! On a plane across an axis through the origin a wall of three axes on estimated states therefore is the wall of one axis, bit for bit.

use super::number::Spatial;
use super::vector::Vector;
use crate::estimator::{Estimator, EstimatorState};
use crate::{Force, Position};

/// The predicted HIP that the shells work with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceAhead<N: Spatial> {
    /// Position at which it will be.
    pub at: Vector<Position<N>>,
    /// Displacement per tick at that time.
    pub moved: Vector<Position<N>>,
}

/// An estimator an axis, with its memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceEstimator<N: Spatial> {
    axes: [(Estimator<N>, EstimatorState<N>); 3],
}

impl<N: Spatial> PlaceEstimator<N> {
    /// The state before the first sample. Coefficients are in the device's unit: [`super::LengthUnit::estimator`].
    #[must_use]
    pub fn new(axes: [Estimator<N>; 3]) -> Self {
        Self {
            axes: axes.map(|estimator| (estimator, EstimatorState::default())),
        }
    }

    /// Runs one control period: takes a measured position, returns place and displacement for the time at which the
    /// next command begins to act. [`PlaceEstimator::commanded`] must follow.
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

    /// The force on the HIP that was commanded after a tick, after every stage that may change it.
    #[inline]
    pub fn commanded(&mut self, force: Vector<Force<N>>) {
        for ((estimator, state), force) in self.axes.iter_mut().zip(force.0) {
            estimator.commanded(state, force);
        }
    }
}
