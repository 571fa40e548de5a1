//! Prints what one tick of each plant costs: `cargo run --release --example plant_speed`.
//!
//! The loop is closed through walls, so that each tick waits for the one before, as in a run. The times are wall clock
//! of this machine, the least of several repeats; the shares say how many ticks were spent in a wall, and in how many the
//! device turned round, stopped or started.

use std::hint::black_box;
use std::time::Instant;

use touchstone_world::plant::{
    BareCoulomb, BareLinear, Coulomb, Device, HeldCoulomb, HeldLinear, Invalid, Kinematics, MEDIUM,
    Stepper,
};

const TICKS: usize = 1 << 20;
const REPEATS: usize = 15;
const WALL_N_M_PER_RAD: f64 = 0.3;

/// Torque and rest point for a second at 1 kHz, pushing the device into the wall and out of it.
fn inputs() -> Vec<(f64, f64)> {
    (0..1024)
        .map(|tick| {
            let phase = f64::from(tick) * std::f64::consts::TAU / 1024.0;
            (
                0.01 * (2.0 * phase).sin() + 0.004 * (11.0 * phase).sin(),
                0.3 * (2.0 * phase).sin(),
            )
        })
        .collect()
}

fn torque(push: f64, angle: f64) -> f64 {
    push - WALL_N_M_PER_RAD * penetration(angle)
}

/// Two walls, so that a device that nobody holds stays.
fn penetration(angle: f64) -> f64 {
    angle - angle.clamp(-0.02, 0.02)
}

fn measure<P: Stepper>(name: &str, plant: &P) {
    let inputs = inputs();
    let best = |second: &dyn Fn(&mut P::State)| {
        (0..REPEATS)
            .map(|_| {
                let mut state = P::State::at_rest(0.0);
                let start = Instant::now();
                for _ in 0..TICKS / inputs.len() {
                    second(&mut state);
                }
                black_box(state.position());
                start.elapsed().as_secs_f64() * 1e9 / TICKS as f64
            })
            .fold(f64::INFINITY, f64::min)
    };
    // One call crosses a second, so that the call through `dyn` does not count.
    let plain = best(&|state| {
        for &(push, rest) in &inputs {
            let torque = torque(push, state.position());
            plant.step(state, torque, rest);
        }
    });
    let with_loss = best(&|state| {
        let mut loss = 0.0;
        for &(push, rest) in &inputs {
            loss += plant
                .step_with_loss(state, torque(push, state.position()), rest)
                .total_j();
        }
        black_box(loss);
    });

    let mut state = P::State::at_rest(0.0);
    let (mut contact, mut events) = (0, 0);
    for tick in 0..TICKS {
        let (push, rest) = inputs[tick % inputs.len()];
        let before = state.velocity();
        contact += usize::from(penetration(state.position()) != 0.0);
        let torque = torque(push, state.position());
        plant.step(&mut state, torque, rest);
        let after = state.velocity();
        events += usize::from(before != after && before * after <= 0.0);
    }
    let percent = |count: usize| 100.0 * count as f64 / TICKS as f64;
    println!(
        "{name:<14}{plain:>10.1}{with_loss:>12.1}{:>14.1}{:>12.1}",
        percent(contact),
        percent(events)
    );
}

fn main() -> Result<(), Invalid> {
    let friction = Some(Coulomb {
        kinetic: 2e-3,
        breakaway: 2.5e-3,
    });
    let device = Device {
        inertia: 2e-5,
        damping: 3e-4,
        friction,
    };
    println!(
        "{:<14}{:>10}{:>12}{:>14}{:>12}",
        "plant", "ns/tick", "with loss", "contact, %", "events, %"
    );
    measure("bare", &BareLinear::new(&device, 1e-3)?);
    measure("bare, Coulomb", &BareCoulomb::new(&device, 1e-3)?);
    measure("held", &HeldLinear::new(&device, &MEDIUM, 1e-3)?);
    measure("held, Coulomb", &HeldCoulomb::new(&device, &MEDIUM, 1e-3)?);
    Ok(())
}
