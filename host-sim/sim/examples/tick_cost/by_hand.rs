//! The least that a loop without effects can be: read the angle, ask the wall, push the plant.
//!
//! No plan, no sensor, amplifier or crossing types, no recorder, no motion of a rest point. What the planned loop costs beyond
//! these is what absent effects cost.

use crate::scenes::{Pressed, scene};
use touchstone_sim::run::chain::{Amplifier, Ideal};
use touchstone_sim::run::{self, plan};
use touchstone_world::plant::{BareLinear, HeldLinear, Motion as _, State, Stepper};

/// Ticks of the configuration `bare`.
pub fn bare(ticks: u64) -> Option<f64> {
    let scene = scene("bare")?;
    let mut boxed = run::wall(&scene).ok()?;
    let wall = boxed.as_mut();
    let plant = BareLinear::new(&plan::device(&scene), scene.timing.period_s()).ok()?;
    let press = Pressed::new(Ideal);
    let mut state = State::from_array([0.55, 0.0]);
    let surface_rad = scene.wall.surface_rad;
    for _ in 0..ticks {
        let force = wall.at_penetration(state.position() - surface_rad);
        plant.step(&mut state, press.torque(-force), 0.0);
    }
    Some(state.position())
}

/// Ticks of the configuration `held`.
pub fn held_with_encoder(ticks: u64) -> Option<f64> {
    let scene = scene("held")?;
    let mut boxed = run::wall(&scene).ok()?;
    let wall = boxed.as_mut();
    let device = plan::device(&scene);
    let plant = HeldLinear::new(&device, &plan::hand(&scene)?, scene.timing.period_s()).ok()?;
    let press = Pressed::new(Ideal);
    let rest_rad = scene.device.initial_angle_rad?;
    let mut state = State::from_array([rest_rad, 0.0, rest_rad, 0.0]);
    let per_rad = 1.0 / scene.encoder.as_ref()?.step_rad();
    for _ in 0..ticks {
        let shifted = state.position() * per_rad + 0.5;
        let cut = shifted as i64;
        let count = cut - i64::from((cut as f64) > shifted);
        let force = wall.at_count(count);
        plant.step(&mut state, press.torque(-force), rest_rad);
    }
    Some(state.position())
}
