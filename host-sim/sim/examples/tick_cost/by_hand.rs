//! Minimal simulation loops written by hand: compute the torque at the angle, then step the plant.
//!
//! The loops have no mechanics layer, no crossing detection, no recorder and no motion of a rest point. The instructions that the
//! planned loop needs in addition are the cost of effects that a scene does not use. Both loops use the same compiled control law,
//! because a second copy would differ by an instruction or two.

use crate::scenes::{HAND_RAD, JOLT_TICKS, Pressed, scene};
use std::hint::black_box;
use touchstone_sim::run::chain::{Control, Staged};
use touchstone_sim::run::plan;
use touchstone_sim::scene::Scene;
use touchstone_world::plant::{BareLinear, HeldLinear, Kinematics as _, State, Stepper};

/// The control law with the pressing torque added. The law's type is hidden from the optimiser, because in a planned loop the
/// program chooses the law at run time.
fn pressed(scene: &Scene) -> Option<Box<dyn Control>> {
    let control = plan::control(scene).ok()?;
    Some(black_box(Staged::around(control, Pressed::default())))
}

/// Runs `ticks` ticks of the configuration `bare`, a device without a hand, and returns the last angle in rad.
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

/// Runs `ticks` ticks of the configuration `held`, a device with a hand and an encoder, and returns the last angle in rad.
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
