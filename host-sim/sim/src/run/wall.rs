//! The wall that the loop meets once a tick: encoder reading in, force out, whatever law and number format is behind it.

use touchstone_control::law::Sample;
use touchstone_control::{
    Controller, CountScale, Energy, Force, Position, Reported, Settings, SettingsError,
};

/// What the law shows of its inside after a tick, in SI.
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

/// What the guard shows of its inside after a tick.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InsideGuard {
    /// What the hand may still get out, J.
    pub account_j: f64,
    /// Whether it gave the law less than it wanted.
    pub limited: bool,
    /// Whether it has switched the force off for overspeed.
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
    /// The same for scenes without an encoder, rad.
    fn changed_at_penetration(&mut self, penetration_rad: f64);
    /// The inside after the last tick.
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
    /// As [`Controller::new`].
    pub fn new(settings: &Settings, scale: CountScale) -> Result<Self, SettingsError> {
        Ok(Self {
            controller: Controller::new(settings)?,
            scale,
            at_change: None,
        })
    }

    /// The penetration at a count.
    pub(super) fn penetration(&self, count: i64) -> Position<N> {
        self.scale.penetration(count)
    }

    /// Law and guard alone, for a sample that comes from elsewhere than from the controller's own states.
    pub(super) fn told(&mut self, sample: Sample<N>, e: Position<N>) -> Force<N> {
        let wanted = self.controller.law.tick(sample);
        match &mut self.controller.guard {
            None => wanted,
            Some(guard) => guard.tick(e, self.at_change, wanted),
        }
    }
}

impl<N: Reported> Wall for Controlled<N> {
    fn at_count(&mut self, count: i64) -> f64 {
        let e = self.scale.penetration::<N>(count);
        self.controller.tick_with_change(e, self.at_change).to_f64()
    }

    fn at_penetration(&mut self, penetration_rad: f64) -> f64 {
        self.controller
            .tick_with_change(Position::from_f64(penetration_rad), self.at_change)
            .to_f64()
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
        let view = self.controller.view();
        Inside {
            energy_j: view.energy.map_or(f64::NAN, Energy::to_f64),
            offset_rad: view.offset.to_f64(),
            mass_rad: view.mass.map(Position::to_f64),
            guard: self.controller.guard.as_ref().map(|guard| InsideGuard {
                account_j: guard.account().to_f64(),
                limited: guard.limited,
                tripped: guard.tripped,
            }),
        }
    }
}
