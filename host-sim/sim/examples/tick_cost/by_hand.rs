//! The least that a loop without effects can be: read the angle, ask the wall, push the plant.
//!
//! No plan, no sensor, no mechanics, no recorder, no motion of a rest point. What the planned loop costs beyond these is what
//! absent effects cost.

use crate::scenes::{Pressed, scene};
use std::hint::black_box;
use touchstone_control::{CountScale, Fixed32, Si};
use touchstone_sim::run::chain::{Answer, Control, Staged};
use touchstone_sim::run::plan;
use touchstone_sim::run::wall::{Controlled, Wall};
use touchstone_sim::scene::Scene;
use touchstone_world::plant::{BareLinear, HeldLinear, Motion as _, State, Stepper};

/// The same, with its type hidden from the compiler, as a plan's is: a law is chosen when the program runs.
fn unknown(control: Box<dyn Control>) -> Box<dyn Control> {
    black_box(control)
}

/// The law of a scene, without what would tell it the angle.
fn law(scene: &Scene) -> Option<Controlled<Fixed32>> {
    let counts = scene
        .encoder
        .as_ref()
        .map_or(1.0, |encoder| encoder.counts_per_rev);
    let scale = CountScale::new(counts as u32, Si::from_num(scene.wall.surface_rad))?;
    Controlled::new(&scene.settings().ok()?, scale).ok()
}

/// A law that is told the exact angle.
struct Exact {
    wall: Controlled<Fixed32>,
    surface_rad: f64,
}

impl Control for Exact {
    #[inline(never)]
    fn torque_n_m(&mut self, angle_rad: f64) -> f64 {
        -self.wall.at_penetration(angle_rad - self.surface_rad)
    }

    fn answer(&mut self, _: f64) -> Answer {
        unreachable!("nobody records these loops")
    }
}

/// A law that is told the nearest count.
struct Counted {
    wall: Controlled<Fixed32>,
    per_rad: f64,
}

impl Control for Counted {
    #[inline(never)]
    fn torque_n_m(&mut self, angle_rad: f64) -> f64 {
        let shifted = angle_rad * self.per_rad + 0.5;
        let cut = shifted as i64;
        -self.wall.at_count(cut - i64::from((cut as f64) > shifted))
    }

    fn answer(&mut self, _: f64) -> Answer {
        unreachable!("nobody records these loops")
    }
}

/// Ticks of the configuration `bare`.
pub fn bare(ticks: u64) -> Option<f64> {
    let scene = scene("bare")?;
    let exact = Exact {
        wall: law(&scene)?,
        surface_rad: scene.wall.surface_rad,
    };
    let mut control = unknown(Staged::around(Box::new(exact), Pressed::default()));
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
    let counted = Counted {
        wall: law(&scene)?,
        per_rad: 1.0 / scene.encoder.as_ref()?.step_rad(),
    };
    let mut control = unknown(Staged::around(Box::new(counted), Pressed::default()));
    let device = plan::device(&scene);
    let plant = HeldLinear::new(&device, &plan::hand(&scene)?, scene.timing.period_s()).ok()?;
    let rest_rad = scene.device.initial_angle_rad?;
    let mut state = State::from_array([rest_rad, 0.0, rest_rad, 0.0]);
    for _ in 0..ticks {
        let torque = control.torque_n_m(state.position());
        plant.step(&mut state, torque, rest_rad);
    }
    Some(state.position())
}
