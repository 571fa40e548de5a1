//! The wall as the simulation loop calls it once per tick (control period): an encoder reading in, a force out. The trait
//! `Wall` hides control law and number format.

use touchstone_control::law::View;
use touchstone_control::{
    Controller, CountScale, Energy, Force, Guarded, Position, Reported, Settings, SettingsError,
};

/// Internal values of a control law after a tick, in SI units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inside {
    /// Energy that the passivity observer of the control law reports, J; NaN for a law without an observer.
    pub energy_j: f64,
    /// Offset `O` by which the control law has moved the wall's surface, rad.
    pub offset_rad: f64,
    /// Penetration of the control law's virtual filter mass, rad; `None` while the law does not use the mass.
    pub mass_rad: Option<f64>,
    /// Internal values of the energy guard that limits the law's force; `None` without a guard.
    pub guard: Option<InsideGuard>,
    /// Whether a wall is off, because the device is deeper inside it than the number format of positions reaches.
    pub beyond_reach: bool,
}

/// Internal values of the energy guard after a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InsideGuard {
    /// Account of the energy guard, J: energy that the hand may still get out of the wall.
    pub account_j: f64,
    /// Whether the energy guard passed less force than the control law requested.
    pub limited: bool,
    /// Whether the energy guard has switched the force off, because of overspeed or the end of the range of positions.
    pub tripped: bool,
}

/// A control law at the surface of a wall. The loop calls one of the two `at_…` methods once per tick (control period).
pub trait Wall {
    /// Returns the force for an encoder count, N·m, positive out of the wall.
    fn at_count(&mut self, count: i64) -> f64;
    /// Returns the force for an exact penetration in rad, N·m, positive out of the wall. Used for scenes without an encoder.
    fn at_penetration(&mut self, penetration_rad: f64) -> f64;
    /// Reports the force that was really commanded, N·m, after a limit or another effect changed the force of the control law.
    fn commanded(&mut self, force_n_m: f64);
    /// Reports the encoder count at the moment when the motor's torque last changed.
    fn changed_at_count(&mut self, count: i64);
    /// Reports the penetration in rad at the moment when the motor's torque last changed, for scenes without an encoder.
    fn changed_at_penetration(&mut self, penetration_rad: f64);
    /// Returns the internal values of the control law after the last tick.
    fn inside(&self) -> Inside;
}

/// A control law in one number format.
#[derive(Debug, Clone, Copy)]
pub struct Controlled<N: Reported> {
    controller: Controller<N>,
    scale: CountScale,
    /// Penetration at which the motor's torque last changed; `None` if that position is not measured.
    at_change: Option<Position<N>>,
}

impl<N: Reported> Controlled<N> {
    /// Builds the control law from its settings and the scale of the encoder.
    ///
    /// # Errors
    /// Same as [`Controller::new`].
    pub fn new(settings: &Settings, scale: CountScale) -> Result<Self, SettingsError> {
        Ok(Self {
            controller: Controller::new(settings)?,
            scale,
            at_change: None,
        })
    }
}

impl<N: Reported> Controlled<N> {
    /// Runs the control law for one tick (control period) at a penetration. Encoder and exact sensor both call this method, so that
    /// the law is compiled only once.
    #[inline(never)]
    fn force(&mut self, e: Position<N>) -> Force<N> {
        self.controller.tick_with_change(e, self.at_change)
    }
}

impl<N: Reported> Wall for Controlled<N> {
    #[inline]
    fn at_count(&mut self, count: i64) -> f64 {
        self.force(self.scale.penetration::<N>(count)).to_f64()
    }

    #[inline]
    fn at_penetration(&mut self, penetration_rad: f64) -> f64 {
        self.force(Position::from_f64(penetration_rad)).to_f64()
    }

    fn commanded(&mut self, force_n_m: f64) {
        self.controller.commanded(Force::from_f64(force_n_m));
    }

    fn changed_at_count(&mut self, count: i64) {
        self.at_change = Some(self.scale.penetration(count));
    }

    fn changed_at_penetration(&mut self, penetration_rad: f64) {
        self.at_change = Some(Position::from_f64(penetration_rad));
    }

    fn inside(&self) -> Inside {
        let guard = self.controller.guard.as_ref();
        let last = guard.and_then(|guard| guard.last);
        Inside {
            beyond_reach: last.is_some_and(|e| self.controller.is_beyond_reach(e)),
            ..inside(Some(&self.controller.view()), guard)
        }
    }
}

/// Converts the internal values of a control law and its energy guard to SI units. Without a law, the observer's energy is NaN and
/// the offset 0.
pub(super) fn inside<N: Reported>(view: Option<&View<N>>, guard: Option<&Guarded<N>>) -> Inside {
    let energy = view.and_then(|view| view.energy);
    Inside {
        energy_j: energy.map_or(f64::NAN, Energy::to_f64),
        offset_rad: view.map_or(0.0, |view| view.offset.to_f64()),
        mass_rad: view.and_then(|view| view.mass).map(Position::to_f64),
        guard: guard.map(|guard| InsideGuard {
            account_j: guard.account().to_f64(),
            limited: guard.limited,
            tripped: guard.tripped,
        }),
        beyond_reach: false,
    }
}
