//! The wall that the loop meets once a tick: encoder reading in, force out, whatever law and number format is behind it.

use touchstone_control::law::View;
use touchstone_control::{
    Controller, CountScale, Energy, Force, Guarded, Position, Reported, Settings, SettingsError,
};

/// A law's inner values after a tick, in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inside {
    /// The law's observed energy, J; NaN if it observes none.
    pub energy_j: f64,
    /// Offset `O`, rad.
    pub offset_rad: f64,
    /// Penetration of the virtual mass, rad, while it is in use.
    pub mass_rad: Option<f64>,
    /// The guard after the law; `None` without one.
    pub guard: Option<InsideGuard>,
}

/// The guard's inner values after a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InsideGuard {
    /// Energy that the hand may still get out, J.
    pub account_j: f64,
    /// Whether it gave the law less than it wanted.
    pub limited: bool,
    /// Whether it has switched the force off, for overspeed or where positions end.
    pub tripped: bool,
}

/// A law at a surface. One call of either `at_…` a tick.
pub trait Wall {
    /// Force (pushing out of the wall, N·m) for an encoder count.
    fn at_count(&mut self, count: i64) -> f64;
    /// Force for an exact penetration, rad; for scenes without an encoder.
    fn at_penetration(&mut self, penetration_rad: f64) -> f64;
    /// What became of the last force, N·m, where an effect changed it.
    fn commanded(&mut self, force_n_m: f64);
    /// The count at which the motor's torque changed since the last tick.
    fn changed_at_count(&mut self, count: i64);
    /// Same as `changed_at`, for scenes without an encoder, rad.
    fn changed_at_penetration(&mut self, penetration_rad: f64);
    /// The law's internal values after the last tick.
    fn inside(&self) -> Inside;
}

/// A control law in one number format.
#[derive(Debug, Clone, Copy)]
pub struct Controlled<N: Reported> {
    controller: Controller<N>,
    scale: CountScale,
    /// Where the torque changed since the last tick, if that is measured.
    at_change: Option<Position<N>>,
}

impl<N: Reported> Controlled<N> {
    /// A law with its encoder's scale.
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
    /// The controller's tick, whatever the sensor: the one place where a law's code stands in the program.
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
        inside(
            Some(&self.controller.view()),
            self.controller.guard.as_ref(),
        )
    }
}

/// A law's and a guard's inside in SI; without a law there is nothing to see of one.
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
    }
}
