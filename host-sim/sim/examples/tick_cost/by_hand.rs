//! The least that a loop without effects can be: ask the law's side at the angle, push the plant.
//!
//! No mechanics, no crossing, no recorder, no motion of a rest point. What the planned loop costs beyond these is what absent
//! effects cost. The law's side is the plan's in both: a second copy of a law, compiled with this file, comes out an instruction or
//! two longer or shorter by itself.

use crate::scenes::{HAND_RAD, JOLT_TICKS, Pressed, scene};
use std::hint::black_box;
use touchstone_sim::run::chain::{Control, Staged};
use touchstone_sim::run::plan;
use touchstone_sim::scene::Scene;
use touchstone_world::plant::{BareLinear, HeldLinear, Kinematics as _, State, Stepper};

/// The law's side with the press. Its type is hidden from the compiler, as a plan's is: a law is chosen when the program runs.
fn pressed(scene: &Scene) -> Option<Box<dyn Control>> {
    let control = plan::control(scene).ok()?;
    Some(black_box(Staged::around(control, Pressed::default())))
}

/// Ticks of the configuration `bare`.
pub fn bare(ticks: u64) -> Option<f64> {
    let scene = scene("bare")?;
    let mut control = pressed(&scene)?;
    let plant = BareLinear::new(&plan::device(&scene), scene.timing.period_s()).ok()?;
    let mut state = State::from_array([0.55, 0.0]);
    for _ in 0..ticks {
        let torque = control.torque_n_m(state.position());
        plant.step(&mut state, torque, 0.0);
    }
    Some(state.position())
}

/// Ticks of the configuration `held`.
pub fn held_with_encoder(ticks: u64) -> Option<f64> {
    let scene = scene("held")?;
    let mut control = black_box(plan::control(&scene).ok()?);
    let device = plan::device(&scene);
    let plant = HeldLinear::new(&device, &plan::hand(&scene)?, scene.timing.period_s()).ok()?;
    let start_rad = scene.device.initial_angle_rad?;
    let mut state = State::from_array([start_rad, 0.0, start_rad, 0.0]);
    let jolt = u64::from(JOLT_TICKS);
    for begin in (0..ticks).step_by(JOLT_TICKS as usize) {
        let rest_rad = HAND_RAD[(begin / jolt) as usize & 1];
        for _ in begin..ticks.min(begin + jolt) {
            let torque = control.torque_n_m(state.position());
            plant.step(&mut state, torque, rest_rad);
        }
    }
    Some(state.position())
}
