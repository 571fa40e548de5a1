//! The energy guard on three axes: one energy account, with forces and displacements as vectors.
//!
//! The theorem is that of [`crate::guard`], with scalar products for products and lengths for absolute values. The port's energy
//! is the sum over three axes, and each axis has its own inequality. A force of length `|F|` does at most the work `|F| d` over a
//! displacement of length `d`. If each coordinate of a position errs by at most half an encoder count `δ`, the position vector
//! errs by at most `√3/2` counts. So the coefficients are those of the guard of one axis with `√3 δ` in the place of `δ`. Only
//! the charge of each axis for a change of its own force uses `δ`. Derivation: `docs/three-axes.md`.
//!
//! The guard shortens the force and never turns it.

use super::number::Spatial;
use super::vector::Vector;
use crate::guard::{Guard, Overspeed};
use crate::{Energy, Force, GuardSettings, GuardedDevice, Position, SettingsError, Si};

/// Coefficients of the energy guard on three axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VectorGuard<N: Spatial> {
    /// Coefficients as for one axis. `count` is twice the error of a position vector, `slack` belongs to the error of a single
    /// coordinate.
    pub of_length: Guard<N>,
    /// Coordinate, to either side, from which on no force is allowed: the end of the position format less two largest displacements
    /// per tick.
    edge: Position<N>,
    /// Largest error of a displacement's length: `count` of `of_length` and a step of the number format. The measured length, which
    /// is rounded up, less this error is at most the true length.
    unsure: Position<N>,
}

/// Memory of the energy guard on three axes. The energy account is full at power-up only.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct VectorGuardState<N: Spatial> {
    /// Energy in the account, which the hand may still get out.
    pub account: Energy<N>,
    /// The negative of the last tick's force: a displacement along this vector puts energy into the account.
    pub against: Vector<Force<N>>,
    /// The negative of the force of the tick before the last one.
    pub older: Vector<Force<N>>,
    /// Upper bound of the length of the last tick's force.
    pub size: Force<N>,
}

/// The square root of three, rounded up.
const ROOT_OF_THREE: Si = Si::lit("1.7320509");

impl<N: Spatial> VectorGuard<N> {
    /// Validates the settings and computes the coefficients. Settings and device must already be in the unit of length that the
    /// device uses: [`super::LengthUnit::guard`].
    ///
    /// # Errors
    /// Same as [`Guard::new`].
    pub fn new(settings: &GuardSettings, device: &GuardedDevice) -> Result<Self, SettingsError> {
        let of_axis = Guard::new(settings, device)?;
        let of_length: Guard<N> = Guard::new(
            settings,
            &GuardedDevice {
                count: device.count.saturating_mul(ROOT_OF_THREE),
                ..*device
            },
        )?;
        // The rounding of a position vector is one step of the format larger than that along an axis.
        Ok(Self::of(Guard {
            slack: of_axis.slack,
            count: of_length.count + Position::quantum(),
            in_flight: of_length.in_flight + Position::quantum(),
            ..of_length
        }))
    }

    /// Makes the guard from the coefficients of a guard for one axis that already hold for the lengths of vectors.
    #[must_use]
    pub fn of(of_length: Guard<N>) -> Self {
        let furthest = of_length.furthest;
        Self {
            of_length,
            edge: Position(N::saturating_signal(Si::MAX)) - furthest - furthest,
            unsure: of_length.count + Position::quantum(),
        }
    }

    /// Memory at power-up: a full account, no force.
    #[must_use]
    pub fn full(&self) -> VectorGuardState<N> {
        VectorGuardState {
            account: self.of_length.capacity,
            ..VectorGuardState::default()
        }
    }

    /// Runs one control period with one measured position. Takes the displacement since the last tick and the requested force on
    /// the hand. Returns the allowed force, which has the same direction and at most the same length.
    ///
    /// # Errors
    /// Overspeed: the caller must command no force from now on.
    #[inline]
    pub fn tick(
        &self,
        state: &mut VectorGuardState<N>,
        moved: Vector<Position<N>>,
        wanted: Vector<Force<N>>,
    ) -> Result<Vector<Force<N>>, Overspeed> {
        self.tick_with_change(state, moved, Vector::default(), wanted)
    }

    /// Same as [`VectorGuard::tick`], with the measured position. If any coordinate is within two largest displacements of the
    /// position format's end, no force is allowed: beyond that end a motion would not be counted ([`crate::Guarded::tick`]).
    ///
    /// # Errors
    /// Same as [`VectorGuard::tick`]; also if a force is requested so near to the format's end.
    #[inline]
    pub fn tick_at(
        &self,
        state: &mut VectorGuardState<N>,
        at: Vector<Position<N>>,
        moved: Vector<Position<N>>,
        wanted: Vector<Force<N>>,
    ) -> Result<Vector<Force<N>>, Overspeed> {
        let other_edge = Position::zero() - self.edge;
        let beyond = |x: Position<N>| x >= self.edge || x <= other_edge;
        let [x, y, z] = at.0;
        let ends = (beyond(x) || beyond(y) || beyond(z)) && wanted != Vector::default();
        // The account counts the forces that acted before the force becomes 0. One call for both cases lets the compiler leave out
        // the code for a measured change of force.
        let shown = if ends { Vector::default() } else { wanted };
        let force = self.tick(state, moved, shown)?;
        if ends { Err(Overspeed) } else { Ok(force) }
    }

    /// Same as [`VectorGuard::tick`], with the position also measured when the force changed: `before_change` is the part of
    /// `moved` before that change.
    ///
    /// # Errors
    /// Same as [`VectorGuard::tick`].
    #[inline]
    pub fn tick_with_change(
        &self,
        state: &mut VectorGuardState<N>,
        moved: Vector<Position<N>>,
        before_change: Vector<Position<N>>,
        wanted: Vector<Force<N>>,
    ) -> Result<Vector<Force<N>>, Overspeed> {
        let guard = &self.of_length;
        if moved.is_longer(guard.furthest) || before_change.is_longer(guard.furthest) {
            return self.overrun(state);
        }
        let surely = if moved.is_longer(self.unsure) {
            moved.length_up() - self.unsure
        } else {
            Position::zero()
        };
        let damped = self.damped(surely);
        if state.account < Energy::zero() {
            *state = VectorGuardState {
                account: (state.account + guard.refill + damped).min(guard.capacity),
                ..VectorGuardState::default()
            };
            return Ok(Vector::default());
        }
        let reserve = guard.reserve(state.size);
        let account = self
            .booked(state, moved, before_change)
            .plus_fitting(damped)
            .min(guard.capacity);
        let free = account.minus_fitting(reserve).max(Energy::zero());
        let limit = guard.largest_force(free);
        let length = wanted.length_up();
        let (force, size) = (wanted.shortened(length, limit), length.min(limit));
        *state = VectorGuardState {
            account: free.plus_fitting(reserve),
            against: force.reversed(),
            older: state.against,
            size,
        };
        Ok(force)
    }

    /// Reports the force that was finally commanded, if a later stage made the allowed force shorter. A longer force would break
    /// the energy bound and is counted as the allowed force.
    #[inline]
    pub fn commanded(&self, state: &mut VectorGuardState<N>, force: Vector<Force<N>>) {
        let size = force.length_up();
        if size <= state.size {
            (state.against, state.size) = (force.reversed(), size);
        }
    }

    /// The account's energy after a tick, before damping is added and the sum is limited to the capacity.
    ///
    /// The sum fits its format for the same reason as on one axis: the scalar product of two vectors, and every part of its sum,
    /// is at most the product of their lengths.
    #[inline(always)]
    fn booked(
        &self,
        state: &VectorGuardState<N>,
        moved: Vector<Position<N>>,
        before_change: Vector<Position<N>>,
    ) -> Energy<N> {
        let guard = &self.of_length;
        let grown = state.against - state.older;
        let axes = moved.zip(before_change, |moved, before| (moved, before));
        let forces = state.against.zip(grown, |force, grown| (force, grown));
        let [x, y, z] = axes
            .zip(forces, |(moved, before), (force, grown)| {
                let shrunk = Force::zero() - grown;
                let on = moved - before;
                let under_older = before + guard.late.of_and_fitting(on, guard.stray, grown);
                (force * moved)
                    .plus_fitting(shrunk * under_older)
                    .plus_fitting(grown.min(shrunk) * guard.slack)
            })
            .0;
        state
            .account
            .plus_fitting(guard.refill)
            .plus_fitting(x)
            .plus_fitting(y)
            .plus_fitting(z)
    }

    /// Energy that the trusted damping dissipated over a distance.
    #[inline(always)]
    fn damped(&self, way: Position<N>) -> Energy<N> {
        (self.of_length.damping * way).down_fitting() * way
    }

    /// Overspeed: takes from the account the largest possible loss under the last two forces until the force is off.
    #[cold]
    fn overrun(&self, state: &mut VectorGuardState<N>) -> Result<Vector<Force<N>>, Overspeed> {
        let size = state.size.max(state.older.length_up());
        let lost = size * (self.of_length.overrun * size + Position::quantum());
        *state = VectorGuardState {
            account: state.account - lost,
            ..VectorGuardState::default()
        };
        Err(Overspeed)
    }
}
