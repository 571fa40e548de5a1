//! Runs so many ticks of a named configuration and nothing else: `tick_cost NAME TICKS`, `tick_cost --list`. `tick_cost --ladder FEW
//! MORE` runs the cost ladder in one process: of each configuration few ticks, then more, with a call of [`mark`] before each and after
//! both, at which callgrind can be told to write down what it has counted. `--ladder` alone names the configurations.
//!
//! For counting instructions: two runs of different length under callgrind differ by what the ticks between them cost, exactly.
//! The names ending in `-by-hand` are the minimal loops of [`by_hand`], written without plan and chain; the others are what
//! the plan makes of a scene.

mod by_hand;
mod scenes;

use scenes::{CONFIGURATIONS, HAND_RAD, JOLT_TICKS, Pressed, ladder, scene};
use std::hint::black_box;
use std::process::ExitCode;
use touchstone_sim::run::chain::Staged;
use touchstone_sim::run::plan::Plan;
use touchstone_sim::scene::RestPath;

/// Runs this many ticks of the planned loop of a configuration.
fn planned(name: &str, ticks: u64) -> Option<f64> {
    let scene = scene(name)?;
    let mut plan = Plan::of(&scene).ok()?;
    let mut control = Staged::around(plan.control, Pressed::default());
    let period_s = scene.timing.period_s();
    plan.mechanics
        .advance(control.as_mut(), &plan.motion, 0..ticks, period_s, None);
    Some(plan.mechanics.angle_rad())
}

/// Same as [`planned`], where a hand presses, with nothing but the plan in the loop.
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

/// Marks a point at which callgrind writes its counts; the function keeps its name for that.
#[inline(never)]
fn mark(count: usize) {
    black_box(count);
}

/// Few ticks and then more of every configuration of the ladder, after a look that each can be run: a call of [`mark`] before both and
/// after, so that nothing but ticks lies between the first and the last of the three.
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
            // Bits, so that two loops can be compared.
            println!("{:016x}", black_box(end).to_bits());
            ExitCode::SUCCESS
        }
        None => {
            eprintln!("give a name from --list and a number of ticks");
            ExitCode::from(2)
        }
    }
}
