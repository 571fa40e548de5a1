//! Simulations by Touchstone for the comparison with other physics engines in `tests/rivals/compare.py`. The test problem is a
//! hinge with dry friction that is pressed into a wall.
//!
//! `rivals problem NAME TICKS` prints as JSON: the device, the torque of every tick, the reference's angles under these torques,
//! and the error of Touchstone's closed-form solution. `rivals time NAME TICKS` prints nanoseconds per tick (control period), once
//! for the whole loop (encoder, control law and press) and once for the plant alone under the same torques.
//!
//! No hand model holds the hinge, because not every engine has one. Given torques press the hinge instead.

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;
use touchstone_lab::accuracy::double::Double;
use touchstone_lab::accuracy::reference::Reference;
use touchstone_sim::run::chain::{Stage, Staged};
use touchstone_sim::run::plan::{self, Plan};
use touchstone_sim::run::{Recorder, Tick};
use touchstone_sim::scene::{Preset, Scene};
use touchstone_world::plant::{BareCoulomb, State, Stepper as _};

const SCENE: &str = "
name = \"hinge\"
[device]
inertia_kg_m2 = 1e-4
damping_n_m_s_per_rad = 4e-4
initial_angle_rad = 0.5
[device.friction]
kinetic_n_m = 3e-4
[encoder]
counts_per_rev = 40000
[timing]
rate_hz = 1000
duration_s = 1.0
[wall]
surface_rad = 0.5
k_desired_n_m_per_rad = 0.5
[law]
kind = \"spring\"
";

/// Torque that presses the hinge into the wall, N·m: a mean, plus a square wave of amplitude `swing` that changes sign every
/// `half_period` ticks.
#[derive(Debug, Clone, Copy)]
struct Press {
    mean: f64,
    swing: f64,
    half_period: u64,
    tick: u64,
}

impl Press {
    fn named(name: &str) -> Option<Self> {
        let press = |swing, half_period| {
            Some(Self {
                mean: 0.02,
                swing,
                half_period,
                tick: 0,
            })
        };
        match name {
            // A jolt every 32 ticks, so that the hinge never rests for long.
            "moving" => press(2e-3, 32),
            // The hinge comes to rest within a second, and stays.
            "stuck" => press(0.0, 1),
            _ => None,
        }
    }
}

impl Stage for Press {
    #[inline(always)]
    fn torque_n_m(&mut self, torque_n_m: f64) -> f64 {
        let side = if (self.tick / self.half_period).is_multiple_of(2) {
            self.swing
        } else {
            -self.swing
        };
        self.tick += 1;
        torque_n_m + (self.mean + side)
    }
}

#[derive(Default)]
struct Torques {
    torque: Vec<f64>,
    angle: Vec<f64>,
    stuck: u64,
}

impl Recorder for Torques {
    fn record(&mut self, tick: &Tick) {
        self.torque.push(-tick.motor_force_n_m);
        self.angle.push(tick.angle_after_rad);
        let rests = tick.velocity_rad_per_s == 0.0 && tick.velocity_after_rad_per_s == 0.0;
        self.stuck += u64::from(rests);
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [what, name, ticks] = words.as_slice() else {
        return Err("give problem or time, moving or stuck, and a number of ticks".into());
    };
    let press = Press::named(name).ok_or("give moving or stuck")?;
    let ticks: u64 = ticks.parse()?;
    let scene = Scene::parse(SCENE, "hinge.toml".as_ref())?.with_preset(Preset::Thesis)?;
    let period_s = scene.timing.period_s();
    let mut seen = Torques::default();
    let mut plan = Plan::of(&scene)?;
    let mut control = Staged::around(plan.control, press);
    plan.mechanics.advance(
        control.as_mut(),
        &plan.motion,
        0..ticks,
        period_s,
        Some(&mut seen),
    );
    let device = plan::device(&scene);
    let plant = BareCoulomb::new(&device, period_s)
        .map_err(|invalid| format!("{} is {}", invalid.field, invalid.value))?;
    let start = State::from_array([0.5, 0.0]);
    if what == "time" {
        let mut plan = Plan::of(&scene)?;
        let mut control = Staged::around(plan.control, press);
        let begun = Instant::now();
        plan.mechanics
            .advance(control.as_mut(), &plan.motion, 0..ticks, period_s, None);
        let whole = begun.elapsed();
        black_box(plan.mechanics.angle_rad());
        let begun = Instant::now();
        let mut state = start;
        for torque in &seen.torque {
            plant.step(&mut state, *torque, 0.0);
        }
        let alone = begun.elapsed();
        black_box(state);
        let per_tick = |time: std::time::Duration| time.as_secs_f64() * 1e9 / ticks as f64;
        println!("{:.3} {:.3}", per_tick(whole), per_tick(alone));
        return Ok(());
    }
    let solve = |steps: u32| {
        let mut reference = Reference::new(&device, None, None, steps);
        let mut entries = [0.5, 0.0, 0.0, 0.0].map(Double::from);
        let angles: Vec<f64> = seen
            .torque
            .iter()
            .map(|torque| {
                reference.tick(&mut entries, [*torque, 0.0], period_s);
                entries[0].to_f64()
            })
            .collect();
        (angles, reference.events)
    };
    let (angles, events) = solve(4);
    let (coarse, _) = solve(2);
    let largest = |a: &[f64], b: &[f64]| {
        a.iter()
            .zip(b)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max)
    };
    println!(
        "{}",
        serde_json::json!({
            "inertia": device.inertia,
            "damping": device.damping,
            "friction": device.friction.map(|friction| friction.kinetic),
            "stiffness": scene.wall.k_desired_n_m_per_rad,
            "period": period_s,
            "start": 0.5,
            "torque": seen.torque,
            "angle": angles,
            "events": events,
            "stuck_share": seen.stuck as f64 / ticks as f64,
            "reference_floor": largest(&angles, &coarse),
            "touchstone_error": largest(&angles, &seen.angle),
        })
    );
    Ok(())
}
