//! The wall that the loop meets once a tick: encoder reading in, force out, whatever law and number format is behind it.

use touchstone_control::{
    Controller, CountScale, Energy, Position, Reported, Settings, SettingsError,
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
}

/// A law at a surface. One call of either `at_…` a tick.
pub trait Wall {
    /// Force (pushing out of the wall, N·m) for an encoder count.
    fn at_count(&mut self, count: i64) -> f64;
    /// Force for an exact penetration, rad; for scenes without an encoder.
    fn at_penetration(&mut self, penetration_rad: f64) -> f64;
    /// The inside after the last tick.
    fn inside(&self) -> Inside;
}

/// A control law in one number format.
#[derive(Debug, Clone, Copy)]
pub struct Controlled<N: Reported> {
    controller: Controller<N>,
    scale: CountScale,
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
        })
    }
}

impl<N: Reported> Wall for Controlled<N> {
    fn at_count(&mut self, count: i64) -> f64 {
        let e = self.scale.penetration::<N>(count);
        self.controller.tick(e).to_f64()
    }

    fn at_penetration(&mut self, penetration_rad: f64) -> f64 {
        self.controller
            .tick(Position::from_f64(penetration_rad))
            .to_f64()
    }

    fn inside(&self) -> Inside {
        let view = self.controller.view();
        Inside {
            energy_j: view.energy.map_or(f64::NAN, Energy::to_f64),
            offset_rad: view.offset.to_f64(),
            mass_rad: view.mass.map(Position::to_f64),
        }
    }
}
