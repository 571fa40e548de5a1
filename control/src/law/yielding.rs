//! The surface of a wall that a hand overpowers gives way, as an elastic, perfectly plastic material does.
//!
//! A hand can press harder than the motor. Then the device goes deep into the wall, where a fixed surface would have a law ask for
//! the largest force over a long way. On the way out the energy guard allows that force only until its account is empty. What the
//! guard still allows rises and falls with the position like a spring's force, but without damping, so device and hand swing.
//!
//! So the surface follows a device that a hand pushes on while the law already asks for its largest force: the virtual spring is
//! compressed no further than [`YieldingSurface::deepest`] then. On the way out the law's own spring and damper let the force fall; a
//! law with an offset pushes with that until the device is outside. A surface that gave way goes back with the device, and is where it
//! was drawn once the device is outside the wall.
//!
//! The surface is slower than a device that a broken part drives into the wall, or the monitors would miss it. A faster hand swings.

use super::Sample;
use crate::quotient::over;
use crate::validate::largest_force;
use crate::{Force, Number, Position, Settings, SettingsError, Si};

/// How far a wall's surface has given way, and from which depth on it does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct YieldingSurface<N: Number> {
    /// Largest force that the law commands.
    pub limit: Force<N>,
    /// Penetration up to which the surface never gives way. It is a quarter and a few encoder counts more than the spring's
    /// deformation at the largest force, so that no slow press with less force moves the surface.
    pub deepest: Position<N>,
    /// The most by which the surface gives way in a tick.
    pub step: Position<N>,
    /// Distance by which the surface has moved into the wall; never negative.
    pub given: Position<N>,
}

/// Largest speed at which the surface gives way, as a multiple of [`YieldingSurface::deepest`] per second.
const DEPTHS_PER_SECOND: i64 = 60;
/// The same as a share of the guard's over-speed limit: one in this many. With the shipped limit it is 7.5 rad/s.
const OF_OVERSPEED: i64 = 8;
/// Encoder counts (with the encoder's other errors) in [`YieldingSurface::deepest`].
const COUNTS: i64 = 4;

impl<N: Number> YieldingSurface<N> {
    /// The surface of a wall with these settings. Without an energy guard it never gives way.
    ///
    /// # Errors
    /// The force limit does not fit the number format.
    pub fn surface_of(settings: &Settings) -> Result<Self, SettingsError> {
        if !settings.guard.on {
            return Ok(Self::unyielding());
        }
        let spring = over(settings.force_limit, settings.k_desired);
        let count = settings.position.uncertainty(settings.position_error);
        let deepest = spring
            .saturating_add(spring / 4)
            .saturating_add(count.saturating_mul_int(COUNTS));
        let rate = Si::saturating_from_num(settings.rate_hz);
        let speed = deepest
            .saturating_mul_int(DEPTHS_PER_SECOND)
            .min(settings.guard.overspeed / OF_OVERSPEED);
        let step = over(speed, rate);
        Ok(Self {
            limit: largest_force(settings)?,
            deepest: Position(N::saturating_signal(deepest)),
            step: Position(N::saturating_signal(step)),
            given: Position::zero(),
        })
    }

    /// A surface that never gives way.
    #[must_use]
    pub fn unyielding() -> Self {
        Self {
            limit: Force(N::saturating_signal(Si::MAX)),
            deepest: Position(N::saturating_signal(Si::MAX)),
            step: Position::zero(),
            given: Position::zero(),
        }
    }

    /// The sample as seen from the surface where it is now. A device further outside takes the surface with it.
    #[inline(always)]
    pub fn from_surface(&mut self, sample: Sample<N>) -> Sample<N> {
        if self.given == Position::zero() {
            return sample;
        }
        self.given = self.given.min(sample.e).max(Position::zero());
        Sample {
            e: sample.e - self.given,
            ..sample
        }
    }

    /// Moves the surface with a device that goes further in, if the law asks for its largest force deep inside the wall. `sample` is
    /// what the law got.
    #[inline(always)]
    pub fn give_way(&mut self, sample: Sample<N>, force: Force<N>) {
        if force >= self.limit {
            self.follow(sample);
        }
    }

    /// The rare part of [`YieldingSurface::give_way`], so that every other tick is short.
    #[cold]
    #[inline(never)]
    fn follow(&mut self, sample: Sample<N>) {
        if sample.e > self.deepest && sample.moved > Position::zero() {
            let further = sample.moved.min(sample.e - self.deepest).min(self.step);
            self.given = self.given + further;
        }
    }

    /// Puts the surface back to where it was drawn.
    pub fn forget_push(&mut self) {
        self.given = Position::zero();
    }
}
