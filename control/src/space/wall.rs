//! A tick of three axes: from the position of the HIP to the force on it.

use super::bounding::Bounding;
use super::environment::Surface;
use super::friction::{Friction, FrictionState};
use super::guard::{VectorGuard, VectorGuardState};
use super::magnitude::Magnitude;
use super::number::Spatial;
use super::per_axis::PerAxis;
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
    /// One along the normal.
    Magnitude(Magnitude<N, L>),
    /// One an axis.
    PerAxis(PerAxis<N, L>),
    /// Force bounding of the vector.
    Bounding(Bounding<N>),
}

impl<N: Spatial, L: Along<N>> Shell<N, L> {
    /// One control period: the force on the HIP.
    #[inline]
    pub fn tick(&mut self, touch: &Touch<N>) -> Vector<Force<N>> {
        match self {
            Self::Magnitude(shell) => shell.tick(touch),
            Self::PerAxis(shell) => shell.tick(touch),
            Self::Bounding(shell) => shell.tick(touch),
        }
    }
}

/// An object with its law, friction and guard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpaceWall<N: Spatial, S, L> {
    /// The object.
    pub surface: S,
    /// Which point of it.
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
}

impl<N: Spatial, S: Surface<N>, L: Along<N>> SpaceWall<N, S, L> {
    /// Outside, at rest, without friction and guard.
    pub fn new(surface: S, point: SurfacePoint<N>, shell: Shell<N, L>, limit: Force<N>) -> Self {
        Self {
            surface,
            point,
            shell,
            friction: None,
            limit,
            guard: None,
            last: None,
        }
    }

    /// One control period: the position of the HIP to the force on it.
    ///
    /// # Errors
    /// Overspeed, of a guard: the force is 0, and the caller has to switch off.
    #[inline]
    pub fn tick(&mut self, at: Vector<Position<N>>) -> Result<Vector<Force<N>>, Overspeed> {
        let touch = self.point.tick(&self.surface, at);
        let mut force = self.shell.tick(&touch);
        if let Some((friction, state)) = &mut self.friction {
            let pressed = touch.normal.component_of_force(force);
            force = force + friction.tick(state, &touch, pressed);
        }
        let force = force.within(self.limit);
        let moved = self.last.map_or(Vector::default(), |last| at - last);
        self.last = Some(at);
        match &mut self.guard {
            Some((guard, state)) => guard.tick(state, moved, force),
            None => Ok(force),
        }
    }
}
