//! A tick of three axes: from the position of the HIP to the force on it.

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

/// How scalar laws make a vector force.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(clippy::large_enum_variant)]
pub enum Shell<N: Spatial, L> {
    /// One law along the normal.
    Magnitude(Magnitude<N, L>),
    /// One law for each axis.
    PerAxis(PerAxis<N, L>),
    /// Force bounding of the vector.
    Bounding(Bounding<N>),
}

impl<N: Spatial, L: Along<N>> Shell<N, L> {
    /// Runs one control period; returns the force on the HIP.
    #[inline]
    pub fn tick(&mut self, touch: &Touch<N>) -> Vector<Force<N>> {
        match self {
            Self::Magnitude(shell) => shell.tick(touch),
            Self::PerAxis(shell) => shell.tick(touch),
            Self::Bounding(shell) => shell.tick(touch),
        }
    }
}

/// A virtual object: its shape, the estimator of the HIP, its law, friction and guard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpaceWall<N: Spatial, S, L> {
    /// The object.
    pub surface: S,
    /// What says where the HIP will be; without one, it is where it is measured.
    pub estimator: Option<PlaceEstimator<N>>,
    /// The point of the object that is touched.
    pub point: SurfacePoint<N>,
    /// The law.
    pub shell: Shell<N, L>,
    /// Friction, where there is any.
    pub friction: Option<(Friction<N>, FrictionState<N>)>,
    /// The longest force ever commanded.
    pub limit: Force<N>,
    /// The guard, where there is one.
    pub guard: Option<(VectorGuard<N>, VectorGuardState<N>)>,
    last: Option<Vector<Position<N>>>,
    /// The force commanded at the last tick, after every later stage that may change it.
    commanded: Vector<Force<N>>,
}

impl<N: Spatial, S: Surface<N>, L: Along<N>> SpaceWall<N, S, L> {
    /// Outside, at rest, without estimator, friction and guard.
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

    /// Runs one control period: takes the measured position of the HIP, returns the force on it.
    ///
    /// If a later stage changes that force, [`SpaceWall::commanded`] must follow.
    ///
    /// # Errors
    /// The guard found overspeed, or a force is wanted at the end of the position format. The force is 0, and the
    /// caller has to switch off.
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
        // The guard keeps the books of the port, and so is told what was measured.
        let moved = self.last.map_or(Vector::default(), |last| at - last);
        self.last = Some(at);
        let guarded = match &mut self.guard {
            Some((guard, state)) => guard.tick_at(state, at, moved, force),
            None => Ok(force),
        };
        self.commanded = guarded.unwrap_or_default();
        guarded
    }

    /// What became of the last tick's force, where a later stage changed it: estimator and guard then count with that.
    #[inline]
    pub fn commanded(&mut self, force: Vector<Force<N>>) {
        self.commanded = force;
        if let Some((guard, state)) = &mut self.guard {
            guard.commanded(state, force);
        }
    }
}
