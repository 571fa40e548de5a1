//! Judges a run and also keeps the values of every tick (control period) as a trace.

use super::judge::Judge;
use super::record::Trace;
use super::tick::{Recorder, Tick};
use super::work::Work;
use crate::error::Result;
use crate::scene::Scene;

#[derive(Debug, Clone)]
pub(super) struct Traced {
    judge: Judge,
    trace: Trace,
    surface_rad: f64,
}

impl Traced {
    /// Prepares a trace for a run of the scene.
    ///
    /// # Errors
    /// The trace would be too long for memory.
    pub fn of(scene: &Scene, judge: Judge) -> Result<Self> {
        Work::of(scene).check_trace(scene)?;
        Ok(Self {
            judge,
            trace: Trace::default(),
            surface_rad: scene.wall.surface_rad,
        })
    }

    pub fn into_parts(self) -> (Judge, Option<Trace>) {
        (self.judge, Some(self.trace))
    }
}

impl Recorder for Traced {
    fn record(&mut self, tick: &Tick) {
        let trace = &mut self.trace;
        trace.time_s.push(tick.time_s);
        trace.angle_rad.push(tick.angle_rad);
        trace.velocity_rad_per_s.push(tick.velocity_rad_per_s);
        trace
            .angle_measured_rad
            .push(tick.told_rad + self.surface_rad);
        trace.hand_rad.push(tick.hand_rad);
        trace.rest_rad.push(tick.rest_rad);
        trace.force_n_m.push(tick.force_n_m);
        trace.surface_rad.push(self.surface_rad);
        trace
            .surface_shifted_rad
            .push(self.surface_rad - tick.inside.offset_rad);
        trace.mass_rad.push(
            tick.inside
                .mass_rad
                .map_or(tick.angle_rad, |mass| mass + self.surface_rad),
        );
        trace.energy_observed_j.push(tick.inside.energy_j);
        // Energy up to the sample, like the observed energy; the energy of this tick is added afterwards.
        trace.energy_true_j.push(self.judge.energy_true_j());
        trace.energy_device_loss_j.push(self.judge.device_loss_j());
        let account = tick.inside.guard.map_or(f64::NAN, |guard| guard.account_j);
        trace.guard_account_j.push(account);
        self.judge.record(tick);
    }
}
