//! Simulates a given number of ticks (control periods) of a named configuration, to count their instructions: `tick_cost NAME
//! TICKS`. `tick_cost --list` prints the names.
//!
//! Under callgrind, two runs of different length differ by exactly the instructions of the additional ticks. Names ending in
//! `-by-hand` are the minimal loops of [`by_hand`]; all others are the loops that the simulation plans for a scene.
//!
//! `tick_cost --ladder FEW MORE` measures a list of configurations in one process. For each it runs FEW ticks, then MORE ticks, and
//! calls [`mark`] before, between and after them, where callgrind can write its counts. `--ladder` alone prints the configurations.

mod by_hand;
mod scenes;

use scenes::{CONFIGURATIONS, HAND_RAD, JOLT_TICKS, Pressed, ladder, scene};
use std::hint::black_box;
use std::process::ExitCode;
use touchstone_sim::run::chain::Staged;
use touchstone_sim::run::plan::Plan;
use touchstone_sim::scene::RestPath;

/// Runs `ticks` ticks of the planned loop of a configuration, and returns the last angle in rad.
fn planned(name: &str, ticks: u64) -> Option<f64> {
    let scene = scene(name)?;
    let mut plan = Plan::of(&scene).ok()?;
    let mut control = Staged::around(plan.control, Pressed::default());
    let period_s = scene.timing.period_s();
    plan.mechanics
        .advance(control.as_mut(), &plan.motion, 0..ticks, period_s, None);
    Some(plan.mechanics.angle_rad())
}

/// Runs `ticks` ticks of the planned loop of a configuration in which a simulated hand presses, and returns the last angle in rad.
/// No torques are added.
fn planned_by_hand(name: &str, ticks: u64) -> Option<f64> {
    let scene = scene(name)?;
    let mut plan = Plan::of(&scene).ok()?;
    let rests = HAND_RAD.map(|at| {
        let still = scene.with_overrides(&[&format!("device.initial_angle_rad={at}")]);
        RestPath::from_scene(&still.ok()?).ok()
    });
    let (period_s, jolt) = (scene.timing.period_s(), u64::from(JOLT_TICKS));
    for begin in (0..ticks).step_by(JOLT_TICKS as usize) {
        let rest = rests[(begin / jolt) as usize & 1].as_ref()?;
        let part = begin..ticks.min(begin + jolt);
        plan.mechanics
            .advance(plan.control.as_mut(), rest, part, period_s, None);
    }
    Some(plan.mechanics.angle_rad())
}

/// Marks a point at which callgrind writes its counts. The function is never inlined, so that callgrind finds its name.
#[inline(never)]
fn mark(count: usize) {
    black_box(count);
}

/// Runs `few` and then `more` ticks of every configuration of the cost list, after a check that each can run. Calls [`mark`]
/// before, between and after, so that only ticks lie between two marks.
fn climb(few: u64, more: u64) -> Option<()> {
    let names = ladder();
    for name in &names {
        planned(name, few)?;
    }
    for (at, name) in names.iter().enumerate() {
        let scene = scene(name)?;
        let mut plan = Plan::of(&scene).ok()?;
        let mut control = Staged::around(plan.control, Pressed::default());
        let period_s = scene.timing.period_s();
        for ticks in [0..few, few..few + more] {
            mark(at);
            plan.mechanics
                .advance(control.as_mut(), &plan.motion, ticks, period_s, None);
        }
        mark(at);
        black_box(plan.mechanics.angle_rad());
    }
    Some(())
}

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let done = match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["--list"] => {
            for (name, _) in CONFIGURATIONS {
                println!("{name}");
            }
            return ExitCode::SUCCESS;
        }
        ["--ladder"] => {
            for name in ladder() {
                println!("{name}");
            }
            return ExitCode::SUCCESS;
        }
        ["--ladder", few, more] => few
            .parse()
            .ok()
            .zip(more.parse().ok())
            .and_then(|(few, more)| climb(few, more))
            .map(|()| 0.0),
        [name, ticks] => ticks.parse().ok().and_then(|ticks| match name {
            "bare-by-hand" => by_hand::bare(ticks),
            "held-by-hand" => by_hand::held_with_encoder(ticks),
            _ if name.starts_with("held") => planned_by_hand(name, ticks),
            _ => planned(name, ticks),
        }),
        _ => None,
    };
    match done {
        Some(end) => {
            // Prints the bits of the last angle, so that two loops can be compared.
            println!("{:016x}", black_box(end).to_bits());
            ExitCode::SUCCESS
        }
        None => {
            eprintln!("give a name from --list and a number of ticks");
            ExitCode::from(2)
        }
    }
}
