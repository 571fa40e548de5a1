//! One tick of a wall on three axes: from the position of the hand's point (HIP) to the force on it.

use super::bounding::Bounding;
use super::environment::Surface;
use super::friction::{Friction, FrictionState};
use super::guard::{VectorGuard, VectorGuardState};
use super::magnitude::Magnitude;
use super::number::Spatial;
use super::per_axis::PerAxis;
use super::place_estimator::PlaceEstimator;
use super::scalar::Along;
use super::surface_point::SurfacePoint;
use super::touch::Touch;
use super::vector::Vector;
use crate::guard::Overspeed;
use crate::{Force, Position};

/// How laws of one degree of freedom give a force vector on three axes.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(clippy::large_enum_variant)]
pub enum Shell<N: Spatial, L> {
    /// One law along the surface's normal.
    Magnitude(Magnitude<N, L>),
    /// One law for each coordinate axis.
    PerAxis(PerAxis<N, L>),
    /// A spring whose force vector is bounded by energy and damping (force bounding).
    Bounding(Bounding<N>),
}

impl<N: Spatial, L: Along<N>> Shell<N, L> {
    /// Runs one control period; returns the force on the hand's point (HIP).
    #[inline]
    pub fn tick(&mut self, touch: &Touch<N>) -> Vector<Force<N>> {
        match self {
            Self::Magnitude(shell) => shell.tick(touch),
            Self::PerAxis(shell) => shell.tick(touch),
            Self::Bounding(shell) => shell.tick(touch),
        }
    }
}

/// A virtual object with everything that renders it: shape, estimator of the hand's position, law, friction and guard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpaceWall<N: Spatial, S, L> {
    /// The shape of the virtual object.
    pub surface: S,
    /// The estimator that predicts the position of the hand's point (HIP); `None` means that the measured position is used.
    pub estimator: Option<PlaceEstimator<N>>,
    /// The rule that chooses the touched point of the object, with its memory.
    pub point: SurfacePoint<N>,
    /// The law, and how it gives a force vector: along the normal, or one law per axis.
    pub shell: Shell<N, L>,
    /// Friction with its memory; `None` without friction.
    pub friction: Option<(Friction<N>, FrictionState<N>)>,
    /// Largest length of the commanded force.
    pub limit: Force<N>,
    /// The energy guard with its memory; `None` without a guard.
    pub guard: Option<(VectorGuard<N>, VectorGuardState<N>)>,
    last: Option<Vector<Position<N>>>,
    /// The force commanded at the last tick, as changed by later stages such as a current limit.
    commanded: Vector<Force<N>>,
}

impl<N: Spatial, S: Surface<N>, L: Along<N>> SpaceWall<N, S, L> {
    /// A wall before the first touch, without estimator, friction and guard. `limit` is the largest length of the force.
    pub fn new(surface: S, point: SurfacePoint<N>, shell: Shell<N, L>, limit: Force<N>) -> Self {
        Self {
            surface,
            estimator: None,
            point,
            shell,
            friction: None,
            limit,
            guard: None,
            last: None,
            commanded: Vector::default(),
        }
    }

    /// Runs one control period: takes the measured position of the hand's point (HIP), returns the force on it.
    ///
    /// If a later stage changes that force, the caller must report it with [`SpaceWall::commanded`].
    ///
    /// # Errors
    /// The guard detected overspeed, or a force is requested at the end of the position format. The force is 0, and the caller has
    /// to switch off.
    #[inline]
    pub fn tick(&mut self, at: Vector<Position<N>>) -> Result<Vector<Force<N>>, Overspeed> {
        let (seen, moved) = match &mut self.estimator {
            None => (at, None),
            Some(estimator) => {
                estimator.commanded(self.commanded);
                let ahead = estimator.tick(at);
                (ahead.at, Some(ahead.moved))
            }
        };
        let touch = Touch {
            moved,
            ..self.point.tick(&self.surface, seen)
        };
        let mut force = self.shell.tick(&touch);
        if let Some((friction, state)) = &mut self.friction {
            let pressed = touch.normal.component_of_force(force);
            force = force + friction.tick(state, &touch, pressed);
        }
        let force = force.within(self.limit);
        // The guard sums the energy at the hand, so it gets the measured position and not the estimated one.
        let moved = self.last.map_or(Vector::default(), |last| at - last);
        self.last = Some(at);
        let guarded = match &mut self.guard {
            Some((guard, state)) => guard.tick_at(state, at, moved, force),
            None => Ok(force),
        };
        self.commanded = guarded.unwrap_or_default();
        guarded
    }

    /// Reports the force that really was commanded, if a later stage changed the last tick's force. Estimator and guard then
    /// calculate with it.
    #[inline]
    pub fn commanded(&mut self, force: Vector<Force<N>>) {
        self.commanded = force;
        if let Some((guard, state)) = &mut self.guard {
            guard.commanded(state, force);
        }
    }
}
